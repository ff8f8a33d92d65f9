#include "bench/measure/stability.h"

#include <gtest/gtest.h>

#include "core/contact/test/prepared_once.h"
#include "palpate/error.h"

// Some cases of the sweep in docs/safety.md; palpate_stability_sweep runs all of them.
namespace palpate::bench {
namespace {

using contact::test::prepared_once;

constexpr double kEncoder = 1e-5;  // m

void expect_bounded_energy(const StabilityResult& result) {
  EXPECT_FALSE(result.faulted);
  EXPECT_LE(result.given_beyond_taken, energy_bound(result));
}

TEST(Stability, WhereTheCheckDoesNotWarnAPressedTissueLiesStillUnderLightAndFirmHands) {
  for (const char* tissue : {"gallbladder", "heart", "liver", "kidney"}) {
    for (const double rate : {1000.0, 4000.0}) {
      const StabilityBlock block(model::tissue_preset(tissue), rate, prepared_once());
      // Just enough damping and friction for the stiffest case: K = 1,132 N/m, 2 f_c / Delta = 1,200 N/m.
      const haptics::DeviceMechanics device{rate < 2000.0 ? 1.07 : 0.65, 0.006, kEncoder};
      for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
        SCOPED_TRACE(std::string(tissue) + " at " + std::to_string(rate) + " Hz, grip of " +
                     std::to_string(grip.stiffness) + " N/m");
        const StabilityResult result = block.run({model::tissue_preset(tissue), rate, device, grip});
        EXPECT_FALSE(result.check.warns());
        EXPECT_LE(result.peak_to_peak, kStillHold);
        EXPECT_NEAR(result.depth, 15e-3, 0.3e-3) << "friction, softest tissue and lightest hand";
        expect_bounded_energy(result);
      }
    }
  }
}

TEST(Stability, SmoothAndRelaxingTissuesLieStillWhereTheCheckDoesNotWarnAndGiveNoEnergy) {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.law = model::LawKind::kSmooth;
  for (const bool relaxes : {false, true}) {
    if (relaxes) tissue.relaxation = {{0.3, 0.05}, {0.25, 1.0}};
    for (const double rate : {1000.0, 4000.0}) {
      const StabilityBlock block(tissue, rate, prepared_once());
      const haptics::DeviceMechanics device{1.2, 0.006, kEncoder};
      for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
        SCOPED_TRACE(std::to_string(rate) + " Hz, grip of " + std::to_string(grip.stiffness) + " N/m" +
                     (relaxes ? ", relaxing" : ""));
        const StabilityResult result = block.run({tissue, rate, device, grip});
        EXPECT_FALSE(result.check.warns());
        if (!relaxes) {
          EXPECT_LE(result.peak_to_peak, kStillHold);
        }
        expect_bounded_energy(result);
      }
    }
  }
}

// The slew reserve lets it bounce by some mm with less energy than the bound, where it once trembled with
// more.
TEST(Stability, AWallTooStiffForItsDeviceIsWarnedOfAndTremblesNoMoreThanTheControllerLets) {
  const model::TissueParameters wall = linear_tissue(32e3);
  const StabilityResult result = StabilityBlock(wall, 1000.0, prepared_once())
                                     .run({wall, 1000.0, {0.1, 0.0, kEncoder}, scene::kLightGrip});
  EXPECT_TRUE(result.check.warns());
  EXPECT_GT(result.peak_to_peak, kStillHold) << "the measure can fail";
  EXPECT_LT(result.peak_to_peak, 5e-3);
  EXPECT_TRUE(result.controlled);
  EXPECT_FALSE(result.faulted);
}

TEST(Stability, TheSameCaseGivesTheSameFigures) {
  const model::TissueParameters wall = linear_tissue(4e3);
  const StabilityBlock block(wall, 1000.0, prepared_once());
  const StabilityCase the_case{wall, 1000.0, {0.5, 0.01, kEncoder}, scene::kLightGrip};
  const StabilityResult first = block.run(the_case);
  const StabilityResult again = block.run(the_case);
  EXPECT_EQ(first.peak_to_peak, again.peak_to_peak);
  EXPECT_EQ(first.force, again.force);
  EXPECT_EQ(first.given_beyond_taken, again.given_beyond_taken);
}

TEST(Stability, ALinearTissueHasOneStiffnessToAnyDepthThatIsPressed) {
  const model::LayeredSpringLaw law(linear_tissue(700.0), model::Direction::kPress, 1e-3);
  for (const double depth : {0.1e-3, 1e-3, 7e-3, 15e-3, 29e-3}) {
    EXPECT_NEAR(law.force_at(depth).force, 700.0 * depth, 1e-9);
    EXPECT_NEAR(law.force_at(depth).stiffness, 700.0, 1e-9);
  }
}

TEST(Stability, TheSweepCoversWhatItSays) {
  const std::vector<StabilityCase> cases = tissue_cases();
  EXPECT_EQ(cases.size(), 4U * 2U * 8U * 7U * 3U);
  for (const StabilityCase& c : cases) {
    ASSERT_GE(c.device.damping, 0.5);
    ASSERT_LE(c.device.damping, 5.0);
    ASSERT_LE(c.device.friction, 0.2);
    ASSERT_EQ(c.device.resolution, kEncoder);
  }
  EXPECT_EQ(wall_cases().size(), 2U * 8U * 7U * 3U * 2U);
}

TEST(Stability, RefusesATissueOrADeviceThatIsNone) {
  EXPECT_THROW(StabilityBlock(linear_tissue(-1.0), 1000.0), ParameterError);
  const model::TissueParameters wall = linear_tissue(1e3);
  const StabilityBlock block(wall, 1000.0, prepared_once());
  EXPECT_THROW((void)block.run({wall, 1000.0, {-1.0, 0.0, kEncoder}, scene::kLightGrip}), ParameterError);
}

}  // namespace
}  // namespace palpate::bench
