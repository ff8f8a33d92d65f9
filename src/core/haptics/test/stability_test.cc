#include "core/haptics/stability.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::haptics {
namespace {

using model::Direction;
using ::testing::HasSubstr;

/// Two layers: 100 N/m to 10 mm, then 4 e^(1/beta) = 8 times that, with beta = 1 / ln 2. Soft along the
/// surface.
model::TissueParameters two_slopes() {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.k1 = 100.0;
  tissue.beta = 1.0 / std::log(2.0);
  tissue.q = 0.9;
  tissue.rest_length = 0.020;
  tissue.min_length = 0.010;
  tissue.contact.damping = 0.5;
  tissue.contact.tangential_stiffness = 50.0;
  return tissue;
}

TEST(Stability, NeedsHalfATickOfTheLargestTangentAndTheVirtualDamping) {
  const StabilityCheck check =
      check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {1.0, 0.05, 1e-5});
  EXPECT_NEAR(check.stiffness, 800.0, 1e-9);
  EXPECT_NEAR(check.damping_needed, 800.0 * 1e-3 / 2.0 + 0.5, 1e-12);
  EXPECT_NEAR(check.stiffness_allowed, 10'000.0, 1e-6);
  EXPECT_FALSE(check.warns());
}

TEST(Stability, VariationOfTheTissueRaisesTheStiffness) {
  const StabilityCheck plain = check_stability(two_slopes(), {}, {});
  const StabilityCheck stiff = check_stability(two_slopes(), {.variation = 1.5}, {});
  EXPECT_NEAR(stiff.stiffness, 1.5 * plain.stiffness, 1e-9);
}

TEST(Stability, DampingAlongTheSurfaceCountsWhereItIsTheLarger) {
  const auto damping_of = [](double tangential) {
    model::TissueParameters tissue = two_slopes();
    tissue.contact.tangential_damping = tangential;
    return check_stability(tissue, {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {}).virtual_damping;
  };
  EXPECT_EQ(damping_of(0.4), 0.5);
  EXPECT_EQ(damping_of(0.75), 0.75);
}

TEST(Stability, WarnsJustBelowTheDampingNeededAndNotAtIt) {
  const auto warns = [](double damping) {
    return check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 1.0},
                           {damping, 0.05, 1e-5})
        .damping_short;
  };
  EXPECT_TRUE(warns(0.899));
  EXPECT_FALSE(warns(0.901));
}

TEST(Stability, TheWorkspacesScaleCounts) {
  const StabilityCheck check =
      check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 2.0}, {1.0, 0.05, 1e-5});
  EXPECT_NEAR(check.stiffness, 1600.0, 1e-9);
  EXPECT_NEAR(check.virtual_damping, 1.0, 1e-12);
}

TEST(Stability, AFasterLoopNeedsLessDamping) {
  const auto needed = [](double period) {
    return check_stability(two_slopes(), {.period = period, .max_force = 20.0, .scale = 1.0}, {})
        .damping_needed;
  };
  EXPECT_NEAR(needed(1e-3) - needed(2.5e-4), 800.0 * (1e-3 - 2.5e-4) / 2.0, 1e-12);
}

// ln K is linear from 100 N/m at 5 mm to 800 N/m at 14.5 mm, the middles of the layers, and continues to 15
// mm.
TEST(Stability, TheSmoothLawsOwnTangentCountsAndRelaxationTakesNothingOffIt) {
  model::TissueParameters smooth = two_slopes();
  smooth.law = model::LawKind::kSmooth;
  smooth.t1 = 2.5e-4;  // the second layer's delay is 0.25 ms, the third's 1.25 ms: two layers at 1 kHz
  const double by_hand = 100.0 * std::pow(8.0, (15.0 - 5.0) / (14.5 - 5.0));
  EXPECT_NEAR(check_stability(smooth, {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {}).stiffness,
              by_hand, 1e-6);
  smooth.relaxation = {{0.6, 0.01}};
  EXPECT_NEAR(check_stability(smooth, {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {}).stiffness,
              by_hand, 1e-6);
}

TEST(Stability, ForceThatTheGateHoldsBackIsNotWithinReach) {
  EXPECT_NEAR(check_stability(two_slopes(), {.period = 1e-3, .max_force = 0.9, .scale = 1.0}, {}).stiffness,
              100.0, 1e-9);
}

TEST(Stability, ATissueThatReachesTheGatesLimitWithinAHundredthOfAMillimetreIsJudgedAsWell) {
  for (const double k1 : {1e6, 2.1e6, 1e9}) {
    model::TissueParameters tissue = two_slopes();
    tissue.k1 = k1;
    const StabilityCheck check =
        check_stability(tissue, {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {10.0, 0.2, 1e-5});
    EXPECT_NEAR(check.stiffness / k1, 1.0, 1e-12);
    EXPECT_TRUE(check.warns()) << k1;
  }
}

TEST(Stability, TheFrictionSpringCountsWhereItIsTheStifferAndThereIsFriction) {
  const auto stiffness_of = [](double tangential, double friction) {
    model::TissueParameters tissue = two_slopes();
    tissue.contact.tangential_stiffness = tangential;
    tissue.contact.friction = friction;
    return check_stability(tissue, {.period = 1e-3, .max_force = 20.0, .scale = 2.0}, {}).stiffness;
  };
  EXPECT_NEAR(stiffness_of(799.0, 0.2), 1600.0, 1e-9);
  EXPECT_NEAR(stiffness_of(5000.0, 0.2), 10'000.0, 1e-9);
  EXPECT_NEAR(stiffness_of(5000.0, 0.0), 1600.0, 1e-9) << "without friction nothing pulls on it";
}

TEST(Stability, TheDepthFromWhichATissueIsStifferThanAsked) {
  const auto depth = [](double stiffness) {
    return depth_of_tangent(two_slopes(), Direction::kPress, 1e-3, stiffness);
  };
  EXPECT_EQ(depth(99.0), 0.0);
  EXPECT_NEAR(depth(101.0), 10e-3, 0.02e-3) << "the second layer";
  EXPECT_EQ(depth(801.0), std::numeric_limits<double>::infinity());
}

TEST(Stability, CoarseSensorsWithoutFrictionWarn) {
  const StabilityCheck coarse =
      check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {5.0, 0.003, 1e-5});
  EXPECT_TRUE(coarse.friction_short) << "2 x 0.003 / 1e-5 = 600 < 800 N/m";
  EXPECT_FALSE(coarse.damping_short);
  const StabilityCheck perfect =
      check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {5.0, 0.0, 0.0});
  EXPECT_EQ(perfect.stiffness_allowed, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(perfect.warns());
}

// A free mass of 3 g with the controller's 10 N s/m: its speed changes sign, and grows, within a tick.
TEST(Stability, AMassThatTheControllersDamperOvershootsIsWarnedOf) {
  const auto check = [](double mass) { return check_stability(two_slopes(), {}, {1.0, 1.0, 1e-6, mass}); };
  EXPECT_TRUE(check(0.003).mass_short);
  EXPECT_TRUE(check(0.003).warns());
  EXPECT_FALSE(check(0.05).mass_short);
  EXPECT_FALSE(check(1.0).mass_short);
  EXPECT_FALSE(check(0.0).mass_short) << "unknown";
  EXPECT_THAT(stability_warnings(check(0.003), {1.0, 1.0, 1e-6, 0.003}),
              ::testing::ElementsAre(HasSubstr("may buzz: its mass, 0.003 kg")));
}

TEST(Stability, ASlewLimitThatHoldsTheTissueBackIsSaid) {
  const auto check = [](double slew) {
    return check_stability(two_slopes(), {.slew = slew}, {5.0, 1.0, 1e-6});
  };
  EXPECT_FALSE(check(5000.0).slew_short);
  EXPECT_NEAR(check(10.0).stiffness_by_slew, 20.0, 1e-12) << "10 N/s / (2 x 0.25 m/s)";
  EXPECT_TRUE(check(10.0).slew_short);
  EXPECT_FALSE(check(10.0).warns()) << "it makes nothing unstable";
  EXPECT_THAT(stability_warnings(check(10.0), {5.0, 1.0, 1e-6}),
              ::testing::ElementsAre(HasSubstr("at most 20 N/m of the tissue's 800 N/m")));
}

// At a beta this small the second layer has no width in steps of the depth.
TEST(Stability, ALayerThinnerThanAnyStepOfDepthCounts) {
  model::TissueParameters tissue = two_slopes();
  tissue.beta = 0.0278;
  EXPECT_NEAR(check_stability(tissue, {}, {}).stiffness / (400.0 * std::exp(1.0 / 0.0278)), 1.0, 1e-12);
}

TEST(Stability, WarningsSayTheFiguresAndWhatHelps) {
  const DeviceMechanics weak{0.1, 0.0, 1e-5};
  const StabilityCheck check =
      check_stability(two_slopes(), {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, weak);
  const std::vector<std::string> warnings = stability_warnings(check, weak);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[0],
              HasSubstr("damping, 0.1 N s/m, is less than this tissue needs at this rate, 0.9 N s/m"));
  EXPECT_THAT(warnings[0], HasSubstr("smaller workspace_scale"));
  EXPECT_THAT(warnings[1], HasSubstr("800 N/m, is more than its friction and sensors allow, 0 N/m"));
  EXPECT_TRUE(stability_warnings(StabilityCheck{}, weak).empty());
}

TEST(Stability, RefusesABadTissueOrPeriod) {
  model::TissueParameters bad = two_slopes();
  bad.k1 = -1.0;
  EXPECT_THROW((void)check_stability(bad, {.period = 1e-3, .max_force = 20.0, .scale = 1.0}, {}),
               ParameterError);
  EXPECT_THROW((void)check_stability(two_slopes(), {.period = 0.0, .max_force = 20.0, .scale = 1.0}, {}),
               ParameterError);
}

}  // namespace
}  // namespace palpate::haptics
