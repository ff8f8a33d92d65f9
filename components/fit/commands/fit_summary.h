#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"

#include "fit/identify/sweep.h"

namespace palpate::app {

/// [setup] The fits, the pooled fit and the sweeps as one JSON document (docs/fitting.md lists its fields).
[[nodiscard]] std::string fit_json(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled,
                                   const std::vector<identify::Sweep>& sweeps);

/// [setup] The fits as a readable summary: one block per specimen, then the pooled fit of several specimens.
/// Each block ends with its warnings.
[[nodiscard]] std::string fit_text(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled);

}  // namespace palpate::app
