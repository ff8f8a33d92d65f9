#include "fit/validate/baselines.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::validate {
namespace {

/// A comparison with a curve of 41 points to 10 mm; its computed values are arbitrary.
ForceComparison baseline_curve(const std::function<double(double)>& force) {
  ForceComparison comparison;
  for (int i = 0; i <= 40; ++i) {
    comparison.measured.displacement.push_back(i * 0.25e-3);
    comparison.measured.force.push_back(force(i * 0.25e-3));
  }
  comparison.errors.scale = comparison.measured.force.back() - comparison.measured.force.front();
  return comparison;
}

DeformationComparison profile(double depth, const std::function<double(double)>& displacement) {
  DeformationComparison comparison;
  comparison.depth = depth;
  for (int i = 0; i <= 30; ++i) {
    comparison.measured.distance.push_back(i * 0.5e-3);
    comparison.measured.displacement.push_back(displacement(i * 0.5e-3));
  }
  return comparison;
}

TEST(ForceBaselines, FindTheLawThatMadeTheData) {
  const auto hertz = baseline_curve([](double d) { return 150.0 * std::pow(d, 1.5); });
  EXPECT_LT(fit_force_baseline(BaselineKind::kHertz, hertz).errors.nrmse, 1e-12);
  const auto line = baseline_curve([](double d) { return 20.0 * d; });
  EXPECT_LT(fit_force_baseline(BaselineKind::kLinear, line).errors.nrmse, 1e-12);
  const auto exponential = baseline_curve([](double d) { return 0.05 * std::expm1(300.0 * d); });
  const BaselineFit fit = fit_force_baseline(BaselineKind::kExponential, exponential);
  EXPECT_LT(fit.errors.nrmse, 1e-5);
  EXPECT_THAT(fit.parameters, testing::HasSubstr("b = 300 1/m"));
  MassSpringPatch patch(40.0);
  const auto springs = baseline_curve([&patch](double d) { return 3.0 * patch.press(d); });
  EXPECT_LT(fit_force_baseline(BaselineKind::kMassSpring, springs).errors.nrmse, 1e-2);
}

// Least squares of a line through 0 by hand: points (1 mm, 2 N), (2 mm, 2 N) and (0, 1 N): a = (2 + 4)/5
// N/mm.
TEST(ForceBaselines, FitALineAsByHand) {
  ForceComparison comparison;
  comparison.measured.displacement = {0.0, 1e-3, 2e-3};
  comparison.measured.force = {1.0, 2.0, 2.0};
  comparison.errors.scale = 1.0;
  const BaselineFit fit = fit_force_baseline(BaselineKind::kLinear, comparison);
  EXPECT_NEAR(fit.evaluate(1e-3), 1.2, 1e-12);
  EXPECT_NEAR(fit.errors.max, 1.0, 1e-12);
}

TEST(ForceBaselines, TakeTheZerosOff) {
  auto line = baseline_curve([](double d) { return 0.3 + 20.0 * std::max(0.0, d - 2e-3); });
  line.zeros = {2e-3, 0.3};
  EXPECT_LT(fit_force_baseline(BaselineKind::kLinear, line).errors.nrmse, 1e-12);
  line.zeros = {20e-3, 0.0};
  EXPECT_THROW((void)fit_force_baseline(BaselineKind::kLinear, line), InputError);
}

TEST(ProfileBaselines, FindTheShapeThatMadeTheData) {
  const auto hertz = profile(2e-3, [](double r) { return hertz_displacement(2e-3, 3e-3, r); });
  EXPECT_LT(fit_profile_baseline(BaselineKind::kHertz, hertz).errors.nrmse, 1e-5);
  const auto cone = profile(2e-3, [](double r) { return 2e-3 * std::max(0.0, 1.0 - r / 7e-3); });
  EXPECT_LT(fit_profile_baseline(BaselineKind::kLinear, cone).errors.nrmse, 1e-5);
  const auto exponential = profile(2e-3, [](double r) { return 2e-3 * std::exp(-r / 4e-3); });
  EXPECT_LT(fit_profile_baseline(BaselineKind::kExponential, exponential).errors.nrmse, 1e-5);
}

TEST(ParseBaselines, TakesNamesBetweenCommasEachOnce) {
  using testing::ElementsAre;
  EXPECT_THAT(parse_baselines("mass-spring,hertz,mass-spring"),
              ElementsAre(BaselineKind::kMassSpring, BaselineKind::kHertz));
  EXPECT_THAT(parse_baselines(""), testing::IsEmpty());
  EXPECT_THROW((void)parse_baselines("hertz,cubic"), InputError);
  EXPECT_THROW((void)parse_baselines("hertz,,linear"), InputError);
}

// Without springs between nodes only the home spring of the pressed node remains.
TEST(MassSpringPatch, IsOneSpringWithoutNeighbours) {
  MassSpringPatch patch(0.0);
  EXPECT_DOUBLE_EQ(patch.press(3e-3), 3e-3);
  EXPECT_DOUBLE_EQ(patch.at(0.0), 3e-3);
  EXPECT_DOUBLE_EQ(patch.at(MassSpringPatch::kSpacing), 0.0);
}

TEST(MassSpringPatch, ComesToRestAndFallsFromTheToolOutwards) {
  MassSpringPatch patch(30.0);
  double force = 0.0;
  for (int i = 0; i < 30; ++i) force = patch.press(6e-3);
  EXPECT_NEAR(patch.press(6e-3), force, 1e-6 * force);
  double last = 6e-3;
  for (int i = 1; i <= 5; ++i) {
    EXPECT_LT(patch.at(i * MassSpringPatch::kSpacing), last);
    last = patch.at(i * MassSpringPatch::kSpacing);
  }
  EXPECT_EQ(last, 0.0);
}

}  // namespace
}  // namespace palpate::validate
