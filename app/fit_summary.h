#pragma once
#include <string>
#include <vector>

#include "palpate/fit.h"
#include "science/fit/sweep.h"

namespace palpate::app {

/// [setup] Everything that was fitted as one JSON document (docs/fitting.md has its fields).
[[nodiscard]] std::string fit_json(const std::vector<fit::SpecimenFit>& fits, const fit::PooledFit& pooled,
                                   const std::vector<fit::Sweep>& sweeps, const fit::Settings& settings);

/// [setup] Fits for people: a block a specimen, the pooled one, then warnings.
[[nodiscard]] std::string fit_text(const std::vector<fit::SpecimenFit>& fits, const fit::PooledFit& pooled,
                                   const fit::Settings& settings);

}  // namespace palpate::app
