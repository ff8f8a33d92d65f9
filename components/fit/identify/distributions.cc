#include "fit/identify/distributions.h"

#include <algorithm>

#include <boost/math/distributions/students_t.hpp>

namespace palpate::identify {

double student_t_quantile(double freedom) {
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 3.0)), 0.975);
}

}  // namespace palpate::identify
