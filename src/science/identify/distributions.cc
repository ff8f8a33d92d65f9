#include "science/identify/distributions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <boost/math/distributions/students_t.hpp>

namespace palpate::identify {

double normal_density(double z) noexcept {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}

double normal_cdf(double z) noexcept { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double student_t_quantile(double freedom) {
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 3.0)), 0.975);
}

}  // namespace palpate::identify
