#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/surface.h"
#include "palpate/validate.h"

#include "fit/validate/baselines.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

using testing::HasSubstr;

/// The tissue computed by hand in docs/model.md: k_1 = 18 N/m, beta = 1.6, q = 0.7, L_1 = 5 mm, t_1 = 10 us.
Law hand_computed() {
  Law law;
  law.tissue.name = "by hand";
  law.tissue.k1 = 18.0;
  law.tissue.beta = 1.6;
  law.tissue.q = 0.7;
  law.tissue.rest_length = 10e-3;
  law.tissue.max_length = 15e-3;
  law.tissue.min_length = 5e-3;
  law.tissue.t1 = 10e-6;
  return law;
}

identify::Specimen specimen(std::vector<double> displacement, std::vector<double> force) {
  identify::Specimen made;
  made.name = "curve";
  made.displacement = std::move(displacement);
  made.force = std::move(force);
  return made;
}

Deformation places(double depth) {
  Deformation made;
  made.name = "side";
  made.depth = depth;
  for (int i = 0; i <= 60; ++i) made.distance.push_back(i * 0.5e-3);
  return made;
}

// By hand: errors 1, -2, 2: RMS sqrt(9/3), largest 2; scale 6.
TEST(ErrorsOf, AreTheOnesComputedByHand) {
  const Errors errors = errors_of({1.0, 4.0, 7.0}, {2.0, 2.0, 9.0}, 6.0);
  EXPECT_DOUBLE_EQ(errors.rms, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(errors.max, 2.0);
  EXPECT_DOUBLE_EQ(errors.nrmse, std::sqrt(3.0) / 6.0);
}

// Layer 1 up to 5 mm: 18 N/m; then 134.5137 N/m: 0.5 N at 8.048016 mm (docs/model.md).
TEST(CompareForce, GivesTheLawsForcesComputedByHand) {
  const auto made =
      compare_force(specimen({0.0, 2.5e-3, 5e-3, 8.048016e-3}, {0.0, 0.045, 0.1, 0.5}), hand_computed(), {});
  EXPECT_NEAR(made.computed[1], 0.045, 1e-12);
  EXPECT_NEAR(made.computed[2], 0.09, 1e-12);
  EXPECT_NEAR(made.computed[3], 0.5, 1e-6);
  EXPECT_NEAR(made.errors.max, 0.01, 1e-9);
  EXPECT_DOUBLE_EQ(made.errors.scale, 0.5);
  EXPECT_DOUBLE_EQ(made.within_jnd, 0.75);  // 0.09 instead of 0.1 is 10 % off
  EXPECT_EQ(made.beyond, 0U);
}

TEST(CompareForce, CountsFromTheFirstContactAndTheSensorsZero) {
  const auto made =
      compare_force(specimen({0.0, 1e-3, 3.5e-3}, {0.2, 0.2, 0.245}), hand_computed(), {1e-3, 0.2});
  EXPECT_NEAR(made.computed[0], 0.2, 1e-12);
  EXPECT_NEAR(made.computed[2], 0.245, 1e-12);
}

TEST(CompareForce, TellsThePointsPastTheTissuesLayers) {
  EXPECT_EQ(compare_force(specimen({1e-3, 20e-3, 30e-3}, {0.0, 1.0, 1.0}), hand_computed(), {}).beyond, 2U);
}

// A step held for one time constant: the force decreases from F_e by g x (1 - 1/e).
TEST(CompareForce, RelaxesOverTheTimesOfTheData) {
  Law law = hand_computed();
  law.tissue.relaxation = {{0.5, 2.0}};
  identify::Specimen held = specimen({5e-3, 5e-3, 5e-3}, {0.09, 0.08, 0.06});
  held.time = {0.0, 1.0, 2.0};
  const auto made = compare_force(held, law, {});
  EXPECT_NEAR(made.computed[0], 0.09, 1e-12);
  EXPECT_NEAR(made.computed[2], 0.09 * (1.0 - 0.5 * (1.0 - std::exp(-1.0))), 1e-12);
}

TEST(LawOfValidation, GivesTheDepthUnderAForceAndRefusesWhatItCannotTake) {
  EXPECT_NEAR(hand_computed().depth_under(0.5), 8.048016e-3, 1e-9);
  EXPECT_THROW((void)hand_computed().depth_under(1e6), InputError);
}

TEST(CompareDeformation, LeavesNothingOfTheModelsOwnProfile) {
  const model::FalloffRatios reach;
  Deformation own = places(4e-3);
  const deform::DisplacementProfile profile(reach, 4e-3, 5e-3, 5e-3);
  for (const double r : own.distance) own.displacement.push_back(profile.at(r));
  const auto made = compare_deformation(own, reach, 0.0, 5e-3);
  EXPECT_EQ(made.errors.max, 0.0);
  EXPECT_EQ(made.depth, 4e-3);
  EXPECT_EQ(made.errors.scale, 4e-3);
}

TEST(CompareDeformation, RefusesAMissingDepthAndAMistakenOne) {
  Deformation own = places(0.0);
  own.displacement.assign(own.size(), 3e-3);
  try {
    (void)compare_deformation(own, {}, 0.0, 5e-3);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("side: the depth is missing"));
  }
  try {
    (void)compare_deformation(own, {}, 1e-3, 5e-3);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("u_mm goes to 3, must be at most twice the depth, 1 mm"));
  }
}

TEST(FitReach, FindsTheReachThatMadeTheProfiles) {
  const model::FalloffRatios truth{0.9, 0.5, 1.7, 0.6};
  std::vector<ProfileSample> samples;
  for (const double depth : {1e-3, 3e-3}) {
    Deformation made = places(depth);
    const deform::DisplacementProfile profile(truth, depth, 5e-3, 5e-3);
    for (const double r : made.distance) made.displacement.push_back(profile.at(r));
    samples.push_back({made, depth, 5e-3});
  }
  const FalloffFit fit = fit_falloff(samples);
  EXPECT_NEAR(fit.reach.contact_ratio, 0.9, 0.01);
  EXPECT_NEAR(fit.reach.weight_ratio, 0.6, 0.01);
  EXPECT_LT(fit.nrmse[0], 1e-3);
  EXPECT_LT(fit.nrmse[1], 1e-3);
  EXPECT_THAT(fit.at_limit, testing::Each(false));
}

/// Profiles for given falloff ratios under a ball of 5 mm, as displayed (R_1 without a bound).
std::vector<ProfileSample> samples_of(const model::FalloffRatios& reach, const std::vector<double>& depths) {
  std::vector<ProfileSample> samples;
  for (const double depth : depths) {
    Deformation made = places(depth);
    const BallSurface surface(reach, depth, 5e-3, {true, 0.0});
    for (const double r : made.distance) made.displacement.push_back(surface.at(r));
    samples.push_back({made, depth, 5e-3});
  }
  return samples;
}

TEST(FitReach, FindsTheExponentThatMadeTheProfilesOfSeveralDepths) {
  for (const double exponent : {0.25, 0.37, 0.5, 0.8}) {
    const model::FalloffRatios truth{0.9, 0.5, 1.7, 0.6, exponent};
    const FalloffFit fit = fit_falloff(samples_of(truth, {1e-3, 2e-3, 4e-3, 8e-3}), {true, 0.0});
    EXPECT_NEAR(fit.reach.depth_exponent, exponent, 1e-3);
    EXPECT_NEAR(fit.reach.contact_ratio, 0.9, 0.01);
    EXPECT_FALSE(fit.exponent_kept);
    EXPECT_EQ(fit.at_limit, std::vector<bool>(5, false));
  }
}

TEST(FitReach, KeepsTheExponentAsGivenWhereTheDepthsAreTooAlikeToDetermineIt) {
  const model::FalloffRatios truth{0.9, 0.5, 1.7, 0.6, 0.3};
  for (const std::vector<double>& depths : {std::vector{3e-3}, std::vector{3e-3, 3.5e-3}}) {
    const FalloffFit fit = fit_falloff(samples_of(truth, depths), {true, 0.0}, 0.7);
    EXPECT_TRUE(fit.exponent_kept);
    EXPECT_EQ(fit.reach.depth_exponent, 0.7);
    EXPECT_FALSE(fit.at_limit[4]);
  }
  // A fixed exponent is not bounded.
  EXPECT_EQ(fit_falloff(samples_of(truth, {3e-3}), {true, 0.0}, 0.01).reach.depth_exponent, 0.01);
  // At a single depth c compensates p: c (3/5)^0.7 = 0.9 (3/5)^0.3.
  const FalloffFit fit = fit_falloff(samples_of(truth, {3e-3}), {true, 0.0}, 0.7);
  EXPECT_NEAR(fit.reach.contact_ratio, 0.9 * std::pow(0.6, -0.4), 0.01);
  EXPECT_LT(fit.nrmse[0], 1e-3);
  EXPECT_FALSE(fit_falloff(samples_of(truth, {3e-3, 3.7e-3}), {true, 0.0}).exponent_kept);
}

TEST(FitReach, SaysThatTheExponentIsAtTheLimitWhereProfilesGrowFasterThanTheirDepth) {
  std::vector<ProfileSample> samples = samples_of({0.9, 0.5, 1.7, 0.6, 1.0}, {2e-3, 4e-3});
  for (double& r : samples[0].deformation.distance) r *= 0.5;  // half as wide as with p = 1
  const FalloffFit fit = fit_falloff(samples, {true, 0.0});
  EXPECT_TRUE(fit.at_limit[4]);
  EXPECT_NEAR(fit.reach.depth_exponent, 1.0, 1e-5);
}

TEST(FitReach, SaysWhichParametersTheDataDoNotDetermine) {
  Deformation near = places(5e-3);  // so narrow that it needs a c below its bound
  for (const double r : near.distance) near.displacement.push_back(r < 0.1e-3 ? 5e-3 : 0.0);
  EXPECT_THAT(fit_falloff({{near, 5e-3, 5e-3}}).at_limit, testing::Contains(true));
}

TEST(FitReach, RefusesNoSampleAndOneWithoutDepthOrRadius) {
  EXPECT_THROW((void)fit_falloff({}), InputError);
  EXPECT_THROW((void)fit_falloff({{places(1e-3), 0.0, 5e-3}}), InputError);
  EXPECT_THROW((void)fit_falloff({{places(1e-3), 1e-3, 0.0}}), InputError);
}

}  // namespace
}  // namespace palpate::validate
