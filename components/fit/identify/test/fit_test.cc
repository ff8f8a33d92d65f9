#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/model/relaxation.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/spring_law.h"

namespace palpate::identify {
namespace {

using model::Direction;
using model::LawKind;

/// k_1 20 N/m, beta 1.8, q 0.7, L_1 6 mm.
model::TissueParameters truth() {
  model::TissueParameters tissue;
  tissue.k1 = 20.0;
  tissue.beta = 1.8;
  tissue.q = 0.7;
  tissue.rest_length = 12e-3;
  tissue.max_length = 18e-3;
  tissue.min_length = 6e-3;
  tissue.t1 = 1e-6;
  return tissue;
}

double force_of(LawKind law, double depth) {
  if (law == LawKind::kSmooth) {
    return model::SmoothSpringLaw(truth(), Direction::kPress, 1e-3).force_at(depth).force;
  }
  return model::LayeredSpringLaw(truth(), Direction::kPress, 1e-3).force_at(depth).force;
}

/// A specimen of that tissue to 15 mm: first contact at 0.1 mm, sensor offset 5 mN, noise as a fraction of
/// the range.
Specimen curve(LawKind law, double noise, std::uint32_t number, int points = 60) {
  Random random(99, number, 0);
  Specimen specimen;
  specimen.name = "curve " + std::to_string(number);
  const double range = force_of(law, 15e-3);
  for (int i = 0; i < points; ++i) {
    const double displacement = 15e-3 * (i + 1) / points;
    specimen.displacement.push_back(displacement);
    specimen.force.push_back(force_of(law, displacement - 1e-4) + 5e-3 + noise * range * random.normal());
  }
  return specimen;
}

Settings settings_for(LawKind law) {
  Settings settings;
  settings.law = law;
  return settings;
}

TEST(FitSpecimen, FindsTheParametersOfCurvesWithoutNoise) {
  for (const LawKind law : {LawKind::kLayered, LawKind::kSmooth}) {
    const SpecimenFit fit = fit_specimen(curve(law, 0.0, 1), settings_for(law), 0, {});
    EXPECT_LT(fit.nrmse, 1e-4);
    EXPECT_NEAR(fit.estimates[0].value, 20.0, 0.2);
    EXPECT_NEAR(fit.estimates[1].value, 1.8, 0.02);
    EXPECT_NEAR(fit.estimates[2].value, 0.7, 0.01);
    EXPECT_NEAR(fit.estimates[3].value, 6e-3, 5e-5);
    EXPECT_NEAR(fit.estimates[4].value, 1e-4, 5e-5);
    EXPECT_NEAR(fit.estimates[5].value, 5e-3, 1e-3);
    EXPECT_EQ(fit.layers_allowed, 6);
    EXPECT_EQ(fit.layers_reached, 4);  // three end at 6 + 4.2 + 2.94 = 13.14 mm
  }
}

// Five noisy curves per law with fixed seeds: a 95 % interval misses one parameter in twenty.
TEST(FitSpecimen, IntervalsHoldTheTruth) {
  const double wanted[] = {20.0, 1.8, 0.7, 6e-3, 1e-4, 5e-3};
  for (const LawKind law : {LawKind::kLayered, LawKind::kSmooth}) {
    int held = 0;
    for (std::uint32_t n = 0; n < 5; ++n) {
      const SpecimenFit fit = fit_specimen(curve(law, 0.01, 10 + n, 30), settings_for(law), n, {});
      EXPECT_LT(fit.nrmse, 0.013);
      for (std::size_t i = 0; i < 6; ++i) {
        const Interval& interval = fit.estimates[i].interval;
        EXPECT_LE(interval.low, fit.estimates[i].value);
        EXPECT_GE(interval.high, fit.estimates[i].value);
        held += wanted[i] >= interval.low && wanted[i] <= interval.high ? 1 : 0;
      }
    }
    EXPECT_GE(held, 26) << model::to_string(law);  // of 30
  }
}

TEST(FitSpecimen, GivesTheSameBitsTwice) {
  Settings settings = settings_for(LawKind::kLayered);
  settings.bootstrap = 3;
  const Specimen specimen = curve(LawKind::kLayered, 0.02, 3);
  const SpecimenFit a = fit_specimen(specimen, settings, 0, {});
  const SpecimenFit b = fit_specimen(specimen, settings, 0, {});
  for (std::size_t i = 0; i < a.estimates.size(); ++i) {
    EXPECT_EQ(a.estimates[i].value, b.estimates[i].value);
    EXPECT_EQ(a.estimates[i].interval.low, b.estimates[i].interval.low);
    EXPECT_EQ(a.estimates[i].bootstrap->high, b.estimates[i].bootstrap->high);
  }
}

// The effect of the outliers alone: compared with the fit of the same curve without these two points.
TEST(FitSpecimen, OutliersHardlyCountAndAreTold) {
  constexpr double kNoise = 0.005;
  Specimen specimen = curve(LawKind::kSmooth, kNoise, 4);
  Specimen without = specimen;
  for (const std::ptrdiff_t i : {41, 20}) {
    without.displacement.erase(without.displacement.begin() + i);
    without.force.erase(without.force.begin() + i);
  }
  specimen.force[20] += 1.0;
  specimen.force[41] -= 0.8;
  const SpecimenFit fit = fit_specimen(specimen, settings_for(LawKind::kSmooth), 0, {});
  const SpecimenFit clean = fit_specimen(without, settings_for(LawKind::kSmooth), 0, {});
  const double sigma = kNoise * force_of(LawKind::kSmooth, 15e-3);
  for (const std::size_t i : {5U, 10U, 15U}) {
    EXPECT_NEAR(fit.curve.fitted[i], clean.curve.fitted[i], 0.15 * sigma) << i;
  }
  EXPECT_NEAR(fit.curve.fitted[30], clean.curve.fitted[29], 0.15 * sigma);
  EXPECT_NEAR(fit.curve.fitted[55], clean.curve.fitted[53], 0.15 * sigma);
  EXPECT_THAT(fit.warnings, testing::Contains(testing::HasSubstr("2 points lie far off the curve")));
}

// A robot whose displacement starts 3 mm deep, with a sensor offset of 0.2 N.
TEST(FitSpecimen, FitsACurveThatBeginsAfterContact) {
  Specimen late;
  late.name = "late";
  for (int i = 0; i < 40; ++i) {
    const double displacement = 6e-3 * i / 39;
    late.displacement.push_back(displacement);
    late.force.push_back(force_of(LawKind::kSmooth, 3e-3 + displacement));
  }
  for (double& force : late.force) force += 0.2;
  const SpecimenFit fit = fit_specimen(late, settings_for(LawKind::kSmooth), 0, {});
  EXPECT_LT(fit.nrmse, 1e-3);
}

TEST(FitSpecimen, SaysThatDataDoNotHaveTheLawsShape) {
  Specimen bump;
  bump.name = "bump";
  for (int i = 0; i < 30; ++i) {
    bump.displacement.push_back(1e-3 * i);
    bump.force.push_back(i >= 15 && i < 20 ? 1.0 : 0.0);
  }
  const SpecimenFit fit = fit_specimen(bump, settings_for(LawKind::kLayered), 0, {});
  EXPECT_THAT(fit.warnings, testing::Contains(testing::HasSubstr("the data do not have the law's shape")));
}

TEST(FitSpecimen, SaysWhatTheDataDoNotDetermine) {
  Specimen line;  // only the first layer: beta and q are arbitrary
  line.name = "line";
  for (int i = 1; i <= 30; ++i) {
    line.displacement.push_back(1e-3 * i / 10);
    line.force.push_back(0.02 * i / 10 + 1e-5 * (i % 3));
  }
  const SpecimenFit fit = fit_specimen(line, settings_for(LawKind::kLayered), 0, {});
  EXPECT_THAT(fit.warnings, testing::Contains(testing::HasSubstr("beta is not determined by the data")));
  EXPECT_THAT(fit.warnings, testing::Contains(testing::HasSubstr("measure to about")));
}

/// Pressed in 1 s, then held, with the given number of points per second.
Specimen press_and_hold(LawKind law, const std::vector<model::RelaxationTerm>& terms, int rate_Hz,
                        int points) {
  const model::Relaxation relaxation(terms, 1.0 / rate_Hz);
  model::RelaxationState state;
  Specimen specimen;
  specimen.name = "hold";
  for (int i = 0; i < points; ++i) {
    const double time = static_cast<double>(i) / rate_Hz;
    const double depth = 15e-3 * std::min(1.0, time);
    specimen.time.push_back(time);
    specimen.displacement.push_back(depth);
    specimen.force.push_back(relaxation.next(state, force_of(law, depth)));
  }
  return specimen;
}

TEST(FitSpecimen, FindsRelaxationOfAPressAndHold) {
  const Specimen exact = press_and_hold(LawKind::kSmooth, {{0.3, 0.4}, {0.25, 6.0}}, 10, 210);
  const double range = *std::max_element(exact.force.begin(), exact.force.end());
  Random random(7, 0, 0);
  Specimen noisy = exact;
  for (double& force : noisy.force) force += 0.02 * range * random.normal();
  Settings settings = settings_for(LawKind::kSmooth);
  settings.relaxation = true;
  const SpecimenFit fit = fit_specimen(noisy, settings, 0, {});
  ASSERT_EQ(fit.terms, 2U);
  const double wanted[] = {0.3, 0.4, 0.25, 6.0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(fit.estimates[4 + i].value / wanted[i], 1.0, 0.5) << i;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) squares += std::pow(fit.curve.fitted[i] - exact.force[i], 2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(exact.size())) / range, 0.03);
}

// The intervals of the covariance belong to the correct relaxation terms.
TEST(FitSpecimen, OrdersRelaxationTermsByTheirTimes) {
  Settings settings = settings_for(LawKind::kSmooth);
  settings.relaxation = true;
  Specimen specimen = press_and_hold(LawKind::kSmooth, {{0.2, 0.15}, {0.2, 1.5}, {0.2, 8.0}}, 20, 420);
  Random random(3, 0, 0);
  for (double& force : specimen.force) force += 2e-3 * random.normal();
  const SpecimenFit fit = fit_specimen(specimen, settings, 0, {});
  ASSERT_GE(fit.terms, 2U);
  for (std::size_t i = 1; i < fit.terms; ++i) EXPECT_LT(fit.shared[3 + 2 * i], fit.shared[5 + 2 * i]);
  for (std::size_t i = 0; i < fit.terms; ++i) {
    const Estimate& time = fit.estimates[5 + 2 * i];
    ASSERT_TRUE(time.covariance.has_value());
    EXPECT_LT(time.covariance->low, time.value);
    EXPECT_GT(time.covariance->high, time.value);
  }
}

TEST(FitSpecimen, RelaxationTooFaintForAnySensorIsNoTerm) {
  Settings settings = settings_for(LawKind::kLayered);
  settings.relaxation = true;
  const Specimen specimen =
      press_and_hold(LawKind::kLayered, {{0.3, 0.4}, {5e-5, 1.5}, {0.25, 6.0}}, 20, 220);
  const SpecimenFit fit = fit_specimen(specimen, settings, 0, {});
  ASSERT_EQ(fit.terms, 2U);
  const double wanted[] = {0.3, 0.4, 0.25, 6.0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(fit.estimates[4 + i].value / wanted[i], 1.0, 1e-3) << i;
}

TEST(FitSpecimen, RefusesRelaxationWithoutTimesAndTooFewPoints) {
  Settings settings = settings_for(LawKind::kLayered);
  settings.relaxation = true;
  EXPECT_THROW((void)fit_specimen(curve(LawKind::kLayered, 0.0, 1), settings, 0, {}), InputError);
  Specimen few = curve(LawKind::kLayered, 0.0, 1);
  few.displacement.resize(5);
  few.force.resize(5);
  EXPECT_THROW((void)fit_specimen(few, settings_for(LawKind::kLayered), 0, {}), InputError);
}

TEST(FitPooled, OneSetOfParametersForSpecimensWithOffsetsOfTheirOwn) {
  std::vector<Specimen> specimens;
  std::vector<SpecimenFit> fits;
  for (std::uint32_t n = 0; n < 3; ++n) {
    specimens.push_back(curve(LawKind::kSmooth, 0.01, 20 + n));
    for (double& force : specimens.back().force) force += 0.01 * n;
    fits.push_back(fit_specimen(specimens.back(), settings_for(LawKind::kSmooth), n, {}));
  }
  const PooledFit pooled = fit_pooled(specimens, fits, settings_for(LawKind::kSmooth), {});
  EXPECT_LT(pooled.nrmse, 0.013);
  EXPECT_EQ(pooled.points, 180U);
  EXPECT_NEAR(pooled.estimates[0].value / 20.0, 1.0, 0.3);
  EXPECT_NEAR(pooled.tissue.rest_length, 2.0 * pooled.estimates[3].value, 1e-12);
  EXPECT_EQ(pooled.tissue.law, LawKind::kSmooth);
  EXPECT_NO_THROW(model::validate(pooled.tissue));
}

// Three straight lines of 20 N/m, 3 mm deep: L_1 is at least 3 mm, and beta and q have no effect.
TEST(FitPooled, TheIntervalOfWhatNoSpecimenTellsIsAllThatWasTried) {
  std::vector<Specimen> specimens;
  std::vector<SpecimenFit> fits;
  for (std::uint32_t n = 0; n < 3; ++n) {
    Random random(9, n, 0);
    Specimen line;
    line.name = "line";
    for (int i = 1; i <= 30; ++i) {
      line.displacement.push_back(1e-4 * i);
      line.force.push_back(20.0 * 1e-4 * i + 1e-4 * random.normal());
    }
    specimens.push_back(line);
    fits.push_back(fit_specimen(specimens.back(), settings_for(LawKind::kLayered), n, {}));
  }
  const PooledFit pooled = fit_pooled(specimens, fits, settings_for(LawKind::kLayered), {});
  EXPECT_TRUE(pooled.estimates[0].determined);
  EXPECT_NEAR(pooled.estimates[0].value, 20.0, 0.2);
  EXPECT_FALSE(pooled.estimates[1].determined);
  EXPECT_LT(pooled.estimates[1].interval.low, 0.21);
  EXPECT_GT(pooled.estimates[1].interval.high, 19.9);
  EXPECT_FALSE(pooled.estimates[2].determined);
  EXPECT_LT(pooled.estimates[2].interval.low, 0.051);
  EXPECT_GT(pooled.estimates[2].interval.high, 2.99);
  EXPECT_FALSE(pooled.estimates[3].determined);
  EXPECT_GT(pooled.estimates[3].interval.low, 2e-3);
  EXPECT_THAT(pooled.warnings, testing::Contains(testing::HasSubstr("q is not determined by the data")));
}

TEST(FitPooled, RefusesNoSpecimensAndFitsOfOthers) {
  EXPECT_THROW((void)fit_pooled({}, {}, {}, {}), InputError);
  EXPECT_THROW((void)fit_pooled({curve(LawKind::kSmooth, 0.0, 1)}, {}, {}, {}), InputError);
}

// A ramp to 10.1 mm in 101 rows, one row that swings back to 9.9 mm, and 200 rows at 10.03 mm, where the
// force falls to half. Nothing of the hold reaches the largest displacement.
TEST(FitSpecimen, LeavesOutAHoldBelowTheLargestDisplacement) {
  Specimen specimen;
  specimen.name = "overshoot";
  const auto add = [&specimen](double mm, double force) {
    specimen.displacement.push_back(1e-3 * mm);
    specimen.force.push_back(force);
  };
  const auto force_at = [](double mm) { return 0.12 * std::expm1(0.25 * mm); };
  for (int i = 1; i <= 101; ++i) add(0.1 * i, force_at(0.1 * i));
  add(9.9, force_at(9.9));
  for (int i = 1; i <= 200; ++i) add(10.03, force_at(10.03) * (0.5 + 0.5 * std::exp(-0.05 * i)));
  const SpecimenFit fit = fit_specimen(specimen, settings_for(LawKind::kSmooth), 0, {});
  EXPECT_LT(fit.nrmse, 0.01);
  const model::SmoothSpringLaw law(tissue_of(fit.shared, settings_for(LawKind::kSmooth)), Direction::kPress,
                                   1e-3);
  EXPECT_NEAR(law.force_at(9e-3).force, force_at(9.0), 0.03 * force_at(9.0));
}

/// The warnings of exponential curves fitted together, one per factor of the force.
std::vector<std::string> pooled_warnings(const std::vector<double>& factors) {
  const Settings settings = settings_for(LawKind::kSmooth);
  std::vector<Specimen> specimens;
  std::vector<SpecimenFit> fits;
  for (const double factor : factors) {
    Specimen specimen;
    specimen.name = "times " + std::to_string(factor);
    for (int i = 0; i <= 60; ++i) {
      specimen.displacement.push_back(12e-3 * i / 60.0);
      specimen.force.push_back(factor * 0.12 * std::expm1(0.25 * 12.0 * i / 60.0));
    }
    specimens.push_back(specimen);
    fits.push_back(fit_specimen(specimen, settings, 0, {}));
  }
  return fit_pooled(specimens, fits, settings, {}).warnings;
}

// A factor 2 of an exponential is the same curve, touched ln(2)/0.25 = 2.8 mm earlier.
TEST(FitPooled, SaysThatSpecimensOfOtherStiffnessPassForOthersTouchedEarlier) {
  using testing::Contains;
  using testing::HasSubstr;
  EXPECT_THAT(pooled_warnings({1.0, 2.0}), Contains(HasSubstr("all specimens together give")));
  EXPECT_THAT(pooled_warnings({1.0, 1.03}), testing::Not(Contains(HasSubstr("all specimens together give"))));
}

}  // namespace
}  // namespace palpate::identify
