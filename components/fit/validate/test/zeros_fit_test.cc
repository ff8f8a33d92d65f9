#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"

#include "fit/identify/least_squares.h"
#include "fit/validate/validation_sets.h"

namespace palpate::validate {
namespace {

/// A single layer longer than the data: 50 N/m.
Law line_law() {
  Law law;
  law.tissue.name = "line";
  law.tissue.k1 = 50.0;
  law.tissue.beta = 2.0;
  law.tissue.q = 0.7;
  law.tissue.t1 = 1e-6;
  law.tissue.rest_length = 80e-3;
  law.tissue.max_length = 120e-3;
  law.tissue.min_length = 40e-3;
  return law;
}

/// Forces of line_law() to 10 mm, with first contact at 0.2 mm and a sensor offset of 5 mN.
identify::Specimen shifted_line() {
  identify::Specimen made;
  made.name = "line";
  for (int i = 0; i <= 100; ++i) {
    const double displacement = 0.1e-3 * i;
    made.displacement.push_back(displacement);
    made.force.push_back(5e-3 + 50.0 * std::max(0.0, displacement - 0.2e-3));
  }
  return made;
}

TEST(FitZeros, FindsTheFirstContactAndTheSensorsZero) {
  const ZerosFit fit = fit_zeros(shifted_line(), line_law());
  EXPECT_NEAR(fit.zeros.first_contact, 0.2e-3, 1e-7);
  EXPECT_NEAR(fit.zeros.force, 5e-3, 5e-6);
  EXPECT_FALSE(fit.at_limit);
  EXPECT_LT(compare_force(shifted_line(), line_law(), fit.zeros).errors.nrmse, 1e-5);
}

// A fifth of the points is 0.3 N too high; the rest alternates by +-1 mN. Beyond contact a straight line
// determines only offset - k c, 5 mN - 50 N/m x 0.2 mm; least squares would give 60 mN more.
TEST(FitZeros, IsHardlyDrawnByOutliers) {
  identify::Specimen specimen = shifted_line();
  for (std::size_t i = 0; i < specimen.size(); ++i) specimen.force[i] += i % 2 == 0 ? 1e-3 : -1e-3;
  for (std::size_t i = 3; i < specimen.size(); i += 5) specimen.force[i] += 0.3;
  const ZerosFit fit = fit_zeros(specimen, line_law());
  EXPECT_NEAR(fit.zeros.force - 50.0 * fit.zeros.first_contact, -5e-3, 1e-3);
}

// Displacements may start anywhere, here 20 mm before first contact with this tissue.
TEST(FitZeros, TakesDisplacementsThatCountFromElsewhere) {
  identify::Specimen specimen = shifted_line();
  for (double& displacement : specimen.displacement) displacement += 20e-3;
  EXPECT_NEAR(fit_zeros(specimen, line_law()).zeros.first_contact, 20.2e-3, 1e-5);
}

// The search covers a quarter of the range, 2.5 mm; first contact is at 4 mm.
TEST(FitZeros, SaysThatTheDataBeginElsewhere) {
  identify::Specimen specimen = shifted_line();
  for (std::size_t i = 0; i < specimen.size(); ++i) {
    specimen.force[i] = 50.0 * std::max(0.0, specimen.displacement[i] - 4e-3);
  }
  EXPECT_TRUE(fit_zeros(specimen, line_law()).at_limit);
}

TEST(FitZeros, ReachesTheRelaxedForceOfATissueThatRelaxes) {
  Law law = line_law();
  law.tissue.relaxation = {{0.5, 1.0}};
  identify::Specimen specimen;
  specimen.name = "held";
  for (int i = 0; i <= 100; ++i) {
    specimen.time.push_back(0.1 * i);
    specimen.displacement.push_back(std::min(1e-3 * i, 10e-3));
  }
  std::size_t beyond = 0;
  std::vector<double> depths;
  for (const double displacement : specimen.displacement) depths.push_back(displacement - 0.5e-3);
  specimen.force = law.forces_at(depths, beyond);
  identify::relax(law.tissue.relaxation, specimen.time, specimen.force);
  for (double& force : specimen.force) force += 0.01;
  const ZerosFit fit = fit_zeros(specimen, law);
  EXPECT_NEAR(fit.zeros.first_contact, 0.5e-3, 1e-6);
  EXPECT_NEAR(fit.zeros.force, 0.01, 1e-4);
}

TEST(FitZeros, RefusesAForceThatNeverChanges) {
  identify::Specimen specimen = shifted_line();
  specimen.force.assign(specimen.size(), 1.0);
  EXPECT_THROW((void)fit_zeros(specimen, line_law()), InputError);
}

}  // namespace
}  // namespace palpate::validate
