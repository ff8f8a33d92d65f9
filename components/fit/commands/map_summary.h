#pragma once
#include <string>

#include "fit/identify/map_fit.h"

namespace palpate::app {

/// [setup] The fit of a map as a readable summary.
[[nodiscard]] std::string map_text(const identify::MapFit& fit);

/// [setup] The fit of a map as one JSON document (docs/lumps.md lists its fields).
[[nodiscard]] std::string map_json(const identify::MapFit& fit);

/// [setup] The inclusions as [[organ.inclusion]] tables of a scene.
[[nodiscard]] std::string map_toml(const identify::MapFit& fit);

/// [setup] The stiffness map as CSV, as [organ.stiffness] reads it.
[[nodiscard]] std::string map_csv(const identify::MapFit& fit);

}  // namespace palpate::app
