#pragma once
#include <vector>

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// A value and its probability.
struct Weighted {
  double value = 0.0;
  double weight = 0.0;
};

/// [setup] Mean, standard deviation and central 95 % interval of a discrete distribution. Quantiles are
/// interpolated linearly between the values, each at the middle of its step of the distribution function.
/// @param values at least one; weights of any sum > 0
[[nodiscard]] Estimate estimate_of(std::vector<Weighted> values);

}  // namespace palpate::psychophysics
