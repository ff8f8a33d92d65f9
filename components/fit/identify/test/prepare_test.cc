// Sensors that are not tared, drift or are tilted, and loops.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/spring_law.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/warnings.h"

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A tissue of 0.12 (exp(0.25 d) - 1) N at a depth of d mm.
double exponential(double depth) { return depth > 0.0 ? 0.12 * (std::exp(250.0 * depth) - 1.0) : 0.0; }

constexpr double kAtTenMillimetres = 1.34190;  // N: 0.12 (exp(2.5) - 1)

/// What differs from a tared sensor and a press that begins at contact.
struct Fault {
  double lead = 0.0;   // m of motion before contact
  double zero = 0.0;   // N
  double slope = 0.0;  // N/m of the sensor's reading over displacement
};

/// Rows every 0.1 mm to 12 mm of depth, with 3 mN of noise.
Specimen pressed(const Fault& fault, std::uint32_t number = 0) {
  Random random(61, number, 0);
  Specimen specimen;
  specimen.name = "pressed";
  for (int i = 0; 1e-4 * i < fault.lead + 12.00001e-3; ++i) {
    const double at = 1e-4 * i;
    specimen.displacement.push_back(at);
    specimen.force.push_back(exponential(at - fault.lead) + fault.zero + fault.slope * at +
                             3e-3 * random.normal());
  }
  return specimen;
}

Settings smooth() {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  return settings;
}

/// Force of the fitted tissue at 10 mm.
double force_at_ten(const SpecimenFit& fit) {
  return model::SmoothSpringLaw(tissue_of(fit.shared, smooth()), model::Direction::kPress, 1e-3)
      .force_at(10e-3)
      .force;
}

double offset_mm(const SpecimenFit& fit) { return 1e3 * fit.estimates[kLawParameters].value; }
double offset_N(const SpecimenFit& fit) { return fit.estimates[kLawParameters + 1].value; }

TEST(Prepared, ASensorThatIsNotTaredGivesTheTissueOfATaredOne) {
  for (const double zero : {-50.0, 0.5, 20.68}) {
    const SpecimenFit fit = fit_specimen(pressed({1e-3, zero, 0.0}), smooth(), 0, {});
    EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres) << zero;
    EXPECT_NEAR(offset_mm(fit), 1.0, 0.2) << zero;
    EXPECT_NEAR(offset_N(fit), zero, 0.01) << zero;
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("subtracted as the sensor's zero"))) << zero;
    EXPECT_NEAR(fit.curve.measured.back(), zero + exponential(12e-3), 0.02) << zero;
  }
}

TEST(Prepared, AZeroThatNoRowBeforeContactShowsIsSubtractedWithAQuestion) {
  for (const double zero : {-0.5, 20.68}) {
    const SpecimenFit fit = fit_specimen(pressed({0.0, zero, 0.0}), smooth(), 0, {});
    EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres) << zero;
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("subtracted as the"))) << zero;
    if (zero > 0.0) {
      EXPECT_THAT(fit.warnings, Contains(HasSubstr("start 1 mm above the tissue"))) << zero;
    }
  }
}

TEST(Prepared, ATiltedOrDriftingBaselineIsSubtractedAndSaidWithItsPlace) {
  for (const double slope : {-20.0, 2.0, 20.0}) {  // mN/mm
    const SpecimenFit fit = fit_specimen(pressed({6e-3, 0.0, slope}), smooth(), 0, {});
    EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres) << slope;
    EXPECT_NEAR(offset_mm(fit), 6.0, 0.2) << slope;
    EXPECT_THAT(fit.warnings,
                Contains(HasSubstr("that ends at a kink: taken as a tilted or drifting sensor")))
        << slope;
  }
}

TEST(Prepared, MotionWithoutContactOverAThirdOfTheWayIsNoLayer) {
  const SpecimenFit fit = fit_specimen(pressed({6e-3, 0.0, 0.0}), smooth(), 0, {});
  EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres);
  EXPECT_NEAR(offset_mm(fit), 6.0, 0.2);
}

TEST(Prepared, LeavesACurveOfATaredSensorAsItIs) {
  for (const Fault& fault : {Fault{}, Fault{1e-3, 0.0, 0.0}}) {
    for (std::uint32_t n = 0; n < 20; ++n) {
      const Specimen specimen = pressed(fault, n);
      const Specimen used = prepared(specimen, smooth());
      EXPECT_EQ(used.force, specimen.force) << n;
      EXPECT_FALSE(used.preparation.contact) << n;
      EXPECT_THAT(used.preparation.notes, IsEmpty()) << n;
    }
  }
}

// The first layer of 20 N/m ends at 5 mm.
TEST(Prepared, TheFirstLayerOfTheLayeredLawIsNoBaseline) {
  Specimen layers;
  for (int i = 1; i <= 40; ++i) {
    layers.displacement.push_back(0.25e-3 * i);
    layers.force.push_back(20.0 * std::min(0.25e-3 * i, 5e-3) + 200.0 * std::max(0.25e-3 * i - 5e-3, 0.0));
  }
  const Specimen used = prepared(layers, Settings{});
  EXPECT_EQ(used.force, layers.force);
  EXPECT_THAT(used.preparation.notes, IsEmpty());
}

/// Loops to 12 mm in rows of 0.1 mm; unloading has 70 % of the loading force. Earlier cycles are stiffer.
Specimen loops(int cycles, bool timed) {
  Specimen specimen;
  specimen.name = "loops";
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    for (int i = 0; i < 240; ++i) {
      const double at = 1e-4 * (i < 120 ? i : 240 - i);
      const double stiffer = 1.0 + 0.1 * (cycles - cycle);
      specimen.displacement.push_back(at);
      specimen.force.push_back(exponential(at) * stiffer * (i <= 120 ? 1.0 : 0.7));
      if (timed) specimen.time.push_back(0.01 * static_cast<double>(specimen.size()));
    }
  }
  return specimen;
}

TEST(Prepared, TheLastLoadingOfALoopIsFittedWithAndWithoutTimes) {
  for (const bool timed : {false, true}) {
    for (const int cycles : {1, 3}) {
      const SpecimenFit fit = fit_specimen(loops(cycles, timed), smooth(), 0, {});
      EXPECT_EQ(fit.points, 121U);
      EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.01 * kAtTenMillimetres) << cycles;
      EXPECT_THAT(fit.warnings,
                  Contains(HasSubstr(
                      cycles == 1 ? "of 240 rows 1 to 121 are fitted, the loading;"
                                  : "of 720 rows 481 to 601 are fitted, the loading of cycle 3 of 3")));
    }
  }
}

TEST(Prepared, RelaxationKeepsAllRowsOfALoop) {
  Settings settings = smooth();
  settings.relaxation = true;
  EXPECT_EQ(prepared(loops(2, true), settings).size(), 480U);
}

TEST(Prepared, ALoopWithoutAWholeLoadingIsSaid) {
  Specimen specimen = loops(1, false);
  std::reverse(specimen.displacement.begin(), specimen.displacement.begin() + 121);  // unloaded twice
  std::reverse(specimen.force.begin(), specimen.force.begin() + 121);
  EXPECT_THAT(prepared(specimen, smooth()).preparation.notes, Contains(HasSubstr("fitted as one curve")));
}

TEST(FitSpecimen, SaysFirstWhatIsWrongWithTheData) {
  const SpecimenFit fit = fit_specimen(pressed({0.0, 20.68, 0.0}), smooth(), 0, {});
  ASSERT_THAT(fit.warnings, testing::SizeIs(testing::Gt(1U)));
  EXPECT_THAT(fit.warnings.front(), HasSubstr("start 1 mm above the tissue"));
}

TEST(CorrelatedWarnings, NameEachSetOfParametersOnce) {
  const std::vector<ParameterLabel> names{{"a", 1.0}, {"b", 1.0}, {"c", 1.0}, {"d", 1.0}, {"e", 1.0}};
  std::vector<std::vector<double>> correlations(5, std::vector<double>(5, 0.5));
  EXPECT_THAT(correlated_warnings(correlations, names), IsEmpty());
  for (const auto& [i, k, r] : {std::tuple{0U, 3U, -0.995}, {1U, 4U, 0.999}, {2U, 3U, 0.991}}) {
    correlations[i][k] = correlations[k][i] = r;
  }
  EXPECT_THAT(
      correlated_warnings(correlations, names),
      testing::ElementsAre("a, c and d are only determined together (correlation over 0.99): read none alone",
                           "b and e are only determined together (correlation over 0.99): read none alone"));
}

TEST(FitPooled, RefusesAFitThatLeavesMoreThanTheForceRange) {
  const Specimen specimen = pressed({});
  SpecimenFit fit = fit_specimen(specimen, smooth(), 0, {});
  fit.nrmse = 1.2;
  try {
    (void)fit_pooled({specimen}, {fit}, smooth(), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("specimen pressed: the fit leaves 120 % of the force range"));
  }
}

}  // namespace
}  // namespace palpate::identify
