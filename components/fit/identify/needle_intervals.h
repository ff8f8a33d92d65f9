#pragma once
#include <vector>

#include "fit/identify/needle_fit.h"
#include "fit/identify/needle_problem.h"

namespace palpate::identify {

/// [setup] The parameters of a tissue's law, relaxation and layers at a solution, with 95 % intervals: by the
/// covariance of the least-squares fit, whose residuals are taken as autocorrelated, or from how the records'
/// own fits scatter where that is wider. @param each fits of the single records, with the same layers and
/// terms
[[nodiscard]] std::vector<NeedleValue> needle_values(const NeedleProblem& problem,
                                                     const NeedlePoint& solution,
                                                     const std::vector<std::vector<double>>& each);

/// [setup] Values alone, in the order of needle_values(), SI. A puncture force is the mean of the records'.
[[nodiscard]] std::vector<double> needle_numbers(const NeedleProblem& problem, const NeedlePoint& solution);

/// [setup] The tissue with its puncture forces.
[[nodiscard]] model::TissueParameters needle_tissue(const NeedleProblem& problem,
                                                    const NeedlePoint& solution);

/// [setup] Effective number of independent residuals.
[[nodiscard]] double effective_rows(const NeedleProblem& problem, const NeedlePoint& solution);

}  // namespace palpate::identify
