#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "fit/identify/sweep.h"

namespace palpate::app {

/// [setup] Sweeps as a JSON list (docs/fitting.md lists its fields).
[[nodiscard]] nlohmann::ordered_json sweeps_json(const std::vector<identify::Sweep>& sweeps);

/// [setup] Sweeps as CSV, one line per swept value. A field without a value is empty.
[[nodiscard]] std::string sweeps_csv(const std::vector<identify::Sweep>& sweeps);

/// [setup] The result of each sweep in one line; empty without sweeps.
[[nodiscard]] std::string sweeps_text(const std::vector<identify::Sweep>& sweeps);

}  // namespace palpate::app
