#include "fit/validate/validation_sets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/surface.h"

namespace palpate::validate {
namespace {

/// u(r) for given falloff ratios under a ball of 5 mm.
Deformation profile_of(const model::FalloffRatios& reach, double depth) {
  Deformation made;
  made.name = "side";
  made.depth = depth;
  const deform::DisplacementProfile profile(reach, depth, 5e-3, 5e-3);
  for (int i = 0; i <= 60; ++i) {
    made.distance.push_back(i * 0.5e-3);
    made.displacement.push_back(profile.at(made.distance.back()));
  }
  return made;
}

Validation of_liver() {
  Validation validation;
  validation.law.tissue = model::tissue_preset("liver");
  return validation;
}

TEST(CompareProfiles, FindsNoErrorInTheTissuesOwnProfiles) {
  Validation validation = of_liver();
  const model::FalloffRatios reach = validation.law.tissue.reach;
  compare_profiles({profile_of(reach, 2e-3), profile_of(reach, 4e-3)}, {0.0, 4e-3}, 5e-3, false, validation);
  ASSERT_EQ(validation.profiles.size(), 2U);
  EXPECT_EQ(validation.profiles[0].ours.depth, 2e-3) << "its own";
  EXPECT_EQ(validation.profiles[1].ours.depth, 4e-3);
  EXPECT_LT(validation.profiles[0].ours.errors.max, 1e-15);
  EXPECT_FALSE(validation.reach.has_value());
}

TEST(CompareProfiles, ComparesWithTheReachThatItFittedFirst) {
  Validation validation = of_liver();
  const model::FalloffRatios wide{1.3, 0.5, 1.7, 0.6};
  compare_profiles({profile_of(wide, 2e-3), profile_of(wide, 4e-3)}, {0.0, 0.0}, 5e-3, true, validation);
  ASSERT_TRUE(validation.reach.has_value());
  EXPECT_EQ(validation.law.tissue.reach.contact_ratio, validation.reach->reach.contact_ratio);
  EXPECT_LT(validation.profiles[0].ours.errors.nrmse, 1e-3);
}

TEST(CompareProfiles, KeepsTheTissuesExponentWhereOneDepthDoesNotDetermineIt) {
  Validation validation = of_liver();
  validation.law.tissue.reach.depth_exponent = 0.4;
  compare_profiles({profile_of(validation.law.tissue.reach, 3e-3)}, {0.0}, 5e-3, true, validation);
  EXPECT_TRUE(validation.reach->exponent_kept);
  EXPECT_EQ(validation.law.tissue.reach.depth_exponent, 0.4);
  EXPECT_LT(validation.profiles[0].ours.errors.nrmse, 1e-3);
}

TEST(CompareProfiles, RefusesAProfileWithoutDepth) {
  Validation validation = of_liver();
  const Deformation unknown = profile_of(validation.law.tissue.reach, 2e-3);
  Deformation without = unknown;
  without.depth = 0.0;
  EXPECT_THROW(compare_profiles({without}, {0.0}, 5e-3, false, validation), InputError);
}

TEST(CompareWithBaselines, FitsEachAndSaysWhatAnEvaluationCosts) {
  Validation validation = of_liver();
  compare_profiles({profile_of(validation.law.tissue.reach, 3e-3)}, {0.0}, 5e-3, false, validation);
  compare_with_baselines({BaselineKind::kHertz, BaselineKind::kLinear}, validation);
  ASSERT_EQ(validation.profiles[0].baselines.size(), 2U);
  for (const BaselineResult& baseline : validation.profiles[0].baselines) {
    EXPECT_GT(baseline.cost_ns, 0.0);
    EXPECT_GT(baseline.fit.errors.rms, validation.profiles[0].ours.errors.rms);
  }
  EXPECT_GT(validation.profiles[0].cost_ns, 0.0);
}

}  // namespace
}  // namespace palpate::validate
