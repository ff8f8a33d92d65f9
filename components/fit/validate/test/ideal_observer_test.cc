// An ideal observer of stiffness finds and misses lumps as people do [Baumgart, Gerling 2010]: in silicone of
// 21 kPa lumps are found more than 75 % of the time at 5 mm depth only.
#include <cmath>

#include <gtest/gtest.h>

#include "palpate/inclusion.h"

namespace palpate::validate {
namespace {

constexpr double kFinger = 8e-3;       // m, radius of a fingertip
constexpr double kPressed = 2.0;       // N, force to which the finger presses
constexpr double kSensorNoise = 0.05;  // N
constexpr double kYoung = 21e3;        // Pa
constexpr double kPoisson = 0.45;

/// Chance that the stiffer of two points is named: the observer compares the force above the lump with that
/// of the uniform tissue at the same depth, with independent noise of Weber's fraction and of the sensor on
/// both.
double chance_to_find(double radius, double depth, double weber) {
  const double hertz = 4.0 / 3.0 * kYoung / (1.0 - kPoisson * kPoisson) * std::sqrt(kFinger);  // N/m^1.5
  const double pressed = std::pow(kPressed / hertz, 2.0 / 3.0);
  const model::InclusionLaw law(radius, depth, 100.0);
  const model::InclusionLaw::Extra extra = law.at(model::PressedTip(kFinger, pressed), 0.0);
  const double rise = extra.energy + 0.4 * pressed * extra.by_depth;  // U_0 = 0.4 F_0 D for Hertz
  const double noise = std::hypot(weber, kSensorNoise / kPressed);
  return 0.5 * std::erfc(-std::log1p(rise) / (std::sqrt(2.0) * noise) / std::sqrt(2.0));
}

TEST(IdealObserver, FindsAHardSphereOfFourMillimetresFiveMillimetresDeepAndMissesItAtFifteen) {
  for (const double weber : {0.05, 0.15}) {
    EXPECT_GT(chance_to_find(4e-3, 5e-3, weber), 0.75) << weber;
    EXPECT_LT(chance_to_find(4e-3, 15e-3, weber), 0.75) << weber;
  }
}

}  // namespace
}  // namespace palpate::validate
