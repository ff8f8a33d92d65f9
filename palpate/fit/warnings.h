#pragma once
#include <string>
#include <vector>

#include "palpate/fit/ensemble.h"
#include "palpate/fit/fit.h"
#include "palpate/fit/minima.h"

namespace palpate::fit {

/// [setup] What a user should know of a specimen's fit before believing it, a sentence each: parameters that
/// the data do not determine, outliers, rows that were averaged, layers that were not reached, hysteresis.
[[nodiscard]] std::vector<std::string> warnings_of(const Minima& minima, const Ensemble& ensemble,
                                                   const SpecimenFit& fit);

}  // namespace palpate::fit
