#include "core/base/normal_distribution.h"
#include "core/base/portable_math.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

double PsychometricFunction::operator()(double level, const Parameters& at) const noexcept {
  constexpr double kLn10 = 2.30258509299404568402;
  if (shape == Shape::kNormal) {
    return 0.5 * at.lapse + (1.0 - at.lapse) * normal_cdf((level - at.location) / at.spread);
  }
  const double power = portable::exp(kLn10 * at.spread * (level - at.location) * decades_per_unit);
  return 1.0 - at.lapse - (1.0 - guess - at.lapse) * portable::exp(-power);
}

double threshold_of(const Parameters& at) noexcept {
  constexpr double kLog10OfLn2 = -0.1591745389548616;  // 1 - exp(-10^x)/2 = 3/4
  return at.location + kLog10OfLn2 / at.spread;
}

double log10_difference_of(const Parameters& at) noexcept {
  constexpr double kUpperQuartile = 0.67448975019608171;  // of the standard normal distribution
  constexpr double kLog10OfE = 0.43429448190325182765;
  return kLog10OfE * portable::log(portable::expm1(kUpperQuartile * at.spread));
}

}  // namespace palpate::psychophysics
