#pragma once
#include <span>
#include <vector>

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

enum class Sigmoid { kNormal, kLogistic };

/// A fitted psychometric function g + (1 - g - l) S(x).
struct FunctionFit {
  double threshold = 0.0;  // S = 0.5
  double width = 0.0;      // from S = 0.05 to S = 0.95
  double lapse = 0.0;
  double guess = 0.0;
  double overdispersion = 0.0;  // eta, 0: binomial, 1: each level has all responses equal

  [[nodiscard]] double correct(double level, Sigmoid sigmoid) const;
};

/// [setup] Fits constant stimuli by the maximum of the posterior of a beta-binomial model, with the priors of
/// [Schuett, Harmeling, Macke, Wichmann 2016]. They assume that the levels cover the whole function.
/// @param levels in ascending order, at least 2 @param counts trials and "yes" or correct answers
/// @param intervals of a forced choice, which fixes g = 1/m; 0 for a yes/no task
/// @throws ParameterError for levels that do not ascend or other counts than levels
[[nodiscard]] FunctionFit fit_function(std::span<const double> levels, std::span<const Count> counts,
                                       Sigmoid sigmoid, int intervals);

}  // namespace palpate::psychophysics
