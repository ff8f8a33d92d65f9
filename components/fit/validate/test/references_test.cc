// The model against finite elements: the references are made by tools/update_references.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/identify.h"
#include "palpate/validate.h"

#include "fit/validate/test/closed_forms.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

constexpr double kRadius = 5e-3;  // m, radius of the ball

/// File of a reference: its name followed by "-profiles.csv" or "-force.csv".
std::string file_of(const std::string& name, const char* ending) {
  std::string file = PALPATE_REFERENCES;
  file += '/';
  file += name;
  return file += ending;
}

/// The profiles of a reference at depths from `from` to `to` [m].
std::vector<ProfileSample> reference_samples_of(const std::string& name, double from, double to) {
  std::vector<ProfileSample> samples;
  for (const Deformation& profile : read_deformations(file_of(name, "-profiles.csv"))) {
    if (profile.depth > from - 1e-9 && profile.depth < to + 1e-9) {
      samples.push_back({profile, profile.depth, kRadius});
    }
  }
  EXPECT_FALSE(samples.empty()) << name;
  return samples;
}

/// Largest error over the profiles, as a fraction of their depth, with falloff ratios fitted to each.
double worst_alone(const std::vector<ProfileSample>& samples, const SurfaceRule& rule = {}) {
  double worst = 0.0;
  for (const ProfileSample& sample : samples) {
    const double error = fit_falloff({sample}, rule).nrmse.front();
    std::printf("%s, own reach: %.2f %%\n", sample.deformation.name.c_str(), 100.0 * error);
    worst = std::max(worst, error);
  }
  return worst;
}

/// Largest error with the same falloff ratios for all profiles.
double worst_together(const std::vector<ProfileSample>& samples, const SurfaceRule& rule = {}) {
  const FalloffFit fit = fit_falloff(samples, rule);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::printf("%s, one reach: %.2f %%\n", samples[i].deformation.name.c_str(), 100.0 * fit.nrmse[i]);
  }
  return *std::max_element(fit.nrmse.begin(), fit.nrmse.end());
}

/// Error of a fit of the smooth law, as a fraction of the force range.
double smooth_error(const std::string& name) {
  identify::Settings settings;
  settings.law = model::LawKind::kSmooth;
  const identify::Specimen specimen = identify::read_specimens(file_of(name, "-force.csv")).front();
  const double error = identify::fit_specimen(specimen, settings, 0, [](double, const std::string&) {}).nrmse;
  std::printf("%s, force: %.2f %%\n", name.c_str(), 100.0 * error);
  return error;
}

// A block is stiffer than a half-space, but by less than 5 % where the contact is small; Hertz's law holds
// there.
TEST(References, BlockIsNearHertzWhereThePressIsShallow) {
  for (const double nu : {0.45, 0.49}) {
    const std::string name = nu < 0.47 ? "block-nu45" : "block-nu49";
    const identify::Specimen force = identify::read_specimens(file_of(name, "-force.csv")).front();
    const double modulus = 10e3 / (1.0 - nu * nu);
    ASSERT_NEAR(force.displacement[2], 0.5e-3, 1e-12);
    EXPECT_NEAR(force.force[2] / hertz_force(modulus, kRadius, 0.5e-3), 1.0, 0.05) << name;
  }
}

TEST(References, BlockHasTheProfileOfOneReachADepthDownToSixMillimetres) {
  EXPECT_LT(worst_alone(reference_samples_of("block-nu45", 1e-3, 6e-3)), 0.01);
  EXPECT_LT(worst_alone(reference_samples_of("block-nu49", 1e-3, 6e-3)), 0.01);
}

TEST(References, BlockHasTheProfileOfOneReachForAllDepthsDownToSixMillimetres) {
  EXPECT_LT(worst_together(reference_samples_of("block-nu45", 1e-3, 6e-3)), 0.02);
  EXPECT_LT(worst_together(reference_samples_of("block-nu49", 1e-3, 6e-3)), 0.02);
}

// Deeper than the ball's radius u(r) misses the goal of 1 %; docs/validation.md gives the error.
TEST(References, BlockStaysNearTheProfileBeyondTheBallsRadius) {
  EXPECT_LT(worst_alone(reference_samples_of("block-nu45", 8e-3, 10e-3)), 0.03);
  EXPECT_LT(worst_alone(reference_samples_of("block-nu49", 8e-3, 10e-3)), 0.03);
}

TEST(References, BlockHasTheSurfaceAsDrawnAtEveryDepth) {
  EXPECT_LT(worst_alone(reference_samples_of("block-nu45", 1e-3, 10e-3), {true, 0.0}), 0.01);
  EXPECT_LT(worst_alone(reference_samples_of("block-nu49", 1e-3, 10e-3), {true, 0.0}), 0.01);
}

TEST(References, BlockHasTheSurfaceAsDrawnOfOneReachForAllDepths) {
  EXPECT_LT(worst_together(reference_samples_of("block-nu45", 1e-3, 10e-3), {true, 0.0}), 0.02);
  EXPECT_LT(worst_together(reference_samples_of("block-nu49", 1e-3, 10e-3), {true, 0.0}), 0.02);
}

TEST(References, OrganHasTheProfileOfOneReachADepth) {
  for (const std::string name : {"organ-nu45-along", "organ-nu45-across"}) {
    EXPECT_LT(worst_alone(reference_samples_of(name, 1e-3, 6e-3)), 0.01) << name;
  }
}

TEST(References, SmoothLawHasTheForceOfBlockAndOrgan) {
  for (const std::string name : {"block-nu45", "block-nu49", "organ-nu45"}) {
    EXPECT_LT(smooth_error(name), 0.015) << name;
  }
}

}  // namespace
}  // namespace palpate::validate
