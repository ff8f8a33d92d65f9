#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "science/identify/sweep.h"

namespace palpate::app {

/// [setup] Everything that was fitted as one JSON document (docs/fitting.md has its fields).
[[nodiscard]] std::string fit_json(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled,
                                   const std::vector<identify::Sweep>& sweeps,
                                   const identify::Settings& settings);

/// [setup] Fits for people: a block a specimen, the pooled one, then warnings.
[[nodiscard]] std::string fit_text(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled, const identify::Settings& settings);

}  // namespace palpate::app
