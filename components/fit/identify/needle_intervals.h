#pragma once
#include <vector>

#include "fit/identify/needle_fit.h"
#include "fit/identify/needle_problem.h"

namespace palpate::identify {

/// [setup] The parameters of a tissue's law, relaxation and layers at a solution, with 95 % intervals: by the
/// covariance of the least-squares fit, whose residuals are taken as autocorrelated, or from how the records'
/// own fits scatter where that is wider. @param each tissues of the single records, with the same layers and
/// terms
[[nodiscard]] std::vector<NeedleValue> needle_values(const NeedleProblem& problem,
                                                     const NeedlePoint& solution,
                                                     const std::vector<model::TissueParameters>& each);

/// [setup] The tissue. A puncture force is the mean of the records'.
[[nodiscard]] model::TissueParameters needle_tissue(const NeedleProblem& problem,
                                                    const NeedlePoint& solution);

/// [setup] Effective number of independent residuals.
[[nodiscard]] double effective_rows(const NeedleProblem& problem, const NeedlePoint& solution);

}  // namespace palpate::identify
