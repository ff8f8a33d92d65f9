// Sensors that are not tared, drift or are tilted, and loops.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"
#include "palpate/identify.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/loading.h"
#include "fit/identify/test/pressed.h"

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

/// Forces of 0.02 d^2 N at every 0.15 mm from a depth to 10 mm, counted from contact.
Specimen quadratic_from(double first_mm) {
  Specimen specimen;
  specimen.name = "quadratic";
  for (double mm = first_mm; mm < 10.0; mm += 0.15) {
    specimen.displacement.push_back(1e-3 * mm);
    specimen.force.push_back(mm > 0.0 ? 0.02 * mm * mm : 0.0);
  }
  return specimen;
}

TEST(Prepared, ACurveThatStartsAtDepthSaysThatNoRowShowsFirstContact) {
  for (const double first : {1.0, 1.7}) {
    const SpecimenFit fit = fit_specimen(quadratic_from(first), smooth(), 0, {});
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("no row shows first contact: at the first row, " +
                                                 std::string(first == 1.0 ? "1" : "1.7") + " mm")))
        << first;
  }
}

TEST(Prepared, ACurveThatStartsAboveTheTissueShowsFirstContact) {
  const SpecimenFit fit = fit_specimen(quadratic_from(-1.0), smooth(), 0, {});
  EXPECT_THAT(fit.warnings, testing::Not(Contains(HasSubstr("no row shows first contact"))));
}

TEST(Prepared, AZeroThatNoRowBeforeContactShowsIsSubtractedWithAQuestion) {
  for (const double zero : {-0.5, 20.68}) {
    const SpecimenFit fit = fit_specimen(pressed({0.0, zero, 0.0}), smooth(), 0, {});
    EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres) << zero;
    EXPECT_THAT(fit.warnings, Contains(HasSubstr("subtracted as the"))) << zero;
    if (zero > 0.0) {
      EXPECT_THAT(fit.warnings, testing::SizeIs(testing::Gt(1U)));
      EXPECT_THAT(fit.warnings.front(), HasSubstr("start 1 mm above the tissue"))
          << "what is wrong with the data";
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

// Rows 0.5 mm apart after 3 mm of air: seven rows before contact.
TEST(Prepared, ASensorThatIsNotTaredIsRightOrGivesNoTissueWhereFewRowsShowContact) {
  for (const double zero : {-20.0, 20.0}) {
    for (std::uint32_t n = 0; n < 4; ++n) {
      Random random(66, n, 0);
      Specimen specimen;
      for (int i = 0; i <= 30; ++i) {
        const double at = 5e-4 * i;
        specimen.displacement.push_back(at);
        specimen.force.push_back(exponential(at - 3e-3) + zero + 3e-3 * random.normal());
      }
      const SpecimenFit fit = fit_specimen(specimen, smooth(), 0, {});
      const double off = force_at_ten(fit) / kAtTenMillimetres - 1.0;
      EXPECT_TRUE(std::abs(off) < 0.03 || !fit.poor.empty()) << zero << ' ' << n << ": " << off;
    }
  }
}

/// A press after 3 mm of air, of a sensor whose reading grows with the square of the displacement.
Specimen pressed_under_curved_drift(double curve, double lead) {
  Specimen specimen = pressed({lead, 0.0, 0.0});
  for (std::size_t i = 0; i < specimen.size(); ++i) {
    specimen.force[i] += curve * specimen.displacement[i] * specimen.displacement[i];
  }
  return specimen;
}

TEST(Prepared, ADriftAlongACurveGivesNoTissueWhereFewRowsShowIt) {
  const SpecimenFit fit = fit_specimen(pressed_under_curved_drift(-4000.0, 3e-3), smooth(), 0, {});
  EXPECT_THAT(fit.poor, HasSubstr("because the sensor drifts and 2.9 mm without contact"));
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("follow a curve")));
}

TEST(Prepared, ADriftThatBendsUpwardsAsASoftTissueGivesNoTissue) {
  const SpecimenFit fit = fit_specimen(pressed_under_curved_drift(4000.0, 3e-3), smooth(), 0, {});
  EXPECT_THAT(fit.poor,
              HasSubstr("bend upwards: a sensor that drifts does so, and a soft tissue looks alike"));
}

TEST(Prepared, ADriftAlongACurveThatManyRowsShowIsSubtracted) {
  const SpecimenFit fit = fit_specimen(pressed_under_curved_drift(-500.0, 20e-3), smooth(), 0, {});
  EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres);
  EXPECT_EQ(fit.poor, "");
}

TEST(Prepared, AFitAsksAboutExchangedColumnsAndWithRelaxationAboutTimes) {
  Specimen specimen = pressed({});
  std::swap(specimen.displacement, specimen.force);
  for (std::size_t i = 0; i < specimen.size(); ++i) {
    specimen.displacement[i] *= 1e-3;
    specimen.force[i] *= 1e3;
  }
  EXPECT_THAT(fit_specimen(specimen, smooth(), 0, {}).warnings,
              Contains(HasSubstr("are the two columns exchanged")));
  Settings settings = smooth();
  settings.relaxation = true;
  specimen = pressed({});
  for (std::size_t i = 0; i < specimen.size(); ++i)
    specimen.time.push_back(20.0 * static_cast<double>(i));  // 5 mm/s, in ms
  EXPECT_THAT(fit_specimen(specimen, settings, 0, {}).warnings, Contains(HasSubstr("is time_s in ms?")));
}

TEST(Prepared, RowsBeforeAJumpAtTheStartAreLeftOutAndNamed) {
  for (const std::size_t rows : {1U, 3U, 8U}) {
    const auto named = Contains(HasSubstr("between row " + std::to_string(rows) + " and the next"));
    Specimen specimen = pressed({});
    std::vector<double> fitted;  // the same forces after each glitch, so one fit of them is enough
    for (const double glitch : {-5.0, 0.8, 5.0}) {
      for (std::size_t i = 0; i < rows; ++i) specimen.force[i] = glitch;
      const Specimen used = prepared(specimen, smooth());
      EXPECT_THAT(used.preparation.notes, named) << glitch;
      EXPECT_EQ(used.size(), specimen.size() - rows) << glitch;
      if (fitted.empty()) fitted = used.force;
      EXPECT_EQ(used.force, fitted) << glitch;
    }
    const SpecimenFit fit = fit_specimen(specimen, smooth(), 0, {});
    EXPECT_NEAR(force_at_ten(fit), kAtTenMillimetres, 0.02 * kAtTenMillimetres) << rows;
    EXPECT_THAT(fit.warnings, named) << rows;
  }
}

TEST(Prepared, AStepOfTheDisplacementAtTheStartIsNoJumpOfTheSensor) {
  Specimen stairs;
  for (int i = 0; i < 200; ++i) {
    stairs.displacement.push_back(1e-3 * (i / 20));
    stairs.force.push_back(0.1 * (i / 20));
  }
  EXPECT_EQ(leave_out_start(stairs).size(), stairs.size());
}

/// A ramp of 10 mm in 1 s, then a hold of 4 s in which half the force relaxes, 100 rows a second.
Specimen ramp_and_hold() {
  Random random(62, 0, 0);
  Specimen specimen;
  for (int i = 0; i <= 500; ++i) {
    const double time = 0.01 * i;
    const double depth = 10e-3 * std::min(1.0, time);
    const double relaxed = time > 1.0 ? 0.5 + 0.5 * std::exp(1.0 - time) : 1.0;
    specimen.time.push_back(time);
    specimen.displacement.push_back(depth);
    specimen.force.push_back(relaxed * exponential(depth) + 3e-3 * random.normal());
  }
  return specimen;
}

TEST(RequireUnsaturated, TakesARampAndAHold) {
  EXPECT_NO_THROW(require_unsaturated(ramp_and_hold(), "a.csv"));
  Specimen coarse = ramp_and_hold();  // a sensor that resolves 0.05 N
  for (double& force : coarse.force) force = 0.05 * std::round(force / 0.05);
  EXPECT_NO_THROW(require_unsaturated(coarse, "a.csv"));
}

TEST(RequireUnsaturated, TakesACreepUnderAConstantForce) {
  Specimen creep = ramp_and_hold();
  for (std::size_t i = 0; i < creep.size(); ++i) {
    if (creep.time[i] < 1.0) continue;
    creep.displacement[i] = 10e-3 + 2e-3 * (1.0 - std::exp(1.0 - creep.time[i]));
    creep.force[i] = exponential(10e-3) + 1e-3 * std::sin(7.0 * static_cast<double>(i));
  }
  EXPECT_NO_THROW(require_unsaturated(creep, "a.csv"));
}

TEST(RequireUnsaturated, RefusesAForceThatStaysWhileTheDisplacementRises) {
  Specimen frozen = ramp_and_hold();
  for (std::size_t i = 60; i < frozen.size(); ++i) frozen.force[i] = frozen.force[60];
  EXPECT_THAT(
      [&] { require_unsaturated(frozen, "a.csv"); },
      testing::ThrowsMessage<InputError>(testing::AllOf(testing::StartsWith("a.csv: force_N stays at"),
                                                        HasSubstr("while the displacement rises"))));
}

TEST(RequireUnsaturated, RefusesAForceThatIsCutOffInTheHold) {
  Specimen cut = ramp_and_hold();
  for (double& force : cut.force) force = std::min(force, 1.2);
  EXPECT_THAT([&] { require_unsaturated(cut, "a.csv"); },
              testing::ThrowsMessage<InputError>(HasSubstr("a.csv: force_N is 1.2 in ")));
}

TEST(RequireUnsaturated, RefusesAForceThatNoLongerChangesInTheHold) {
  Specimen frozen = ramp_and_hold();
  for (std::size_t i = 250; i < frozen.size(); ++i) frozen.force[i] = frozen.force[250];
  EXPECT_THAT([&] { require_unsaturated(frozen, "a.csv"); },
              testing::ThrowsMessage<InputError>(HasSubstr("in 251 rows from row 251 on")));
}

TEST(RequireUnsaturated, TakesAForceOfFewDigitsWithoutNoise) {
  Specimen rounded = ramp_and_hold();
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    const double relaxed = rounded.time[i] > 1.0 ? 0.5 + 0.5 * std::exp(10.0 * (1.0 - rounded.time[i])) : 1.0;
    rounded.force[i] = 1e-3 * std::round(1e3 * relaxed * exponential(rounded.displacement[i]));
  }
  EXPECT_NO_THROW(require_unsaturated(rounded, "a.csv"));
}

TEST(FitSpecimen, RefusesASaturatedSensorWithRelaxation) {
  Specimen cut = ramp_and_hold();
  for (double& force : cut.force) force = std::min(force, 0.9);
  Settings settings = smooth();
  settings.relaxation = true;
  EXPECT_THROW((void)fit_specimen(cut, settings, 0, {}), InputError);
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

TEST(Prepared, APartialUnloadingAtTheEndLeavesTheLastLoadingTheLast) {
  Specimen specimen = loops(2, false);
  specimen.displacement.resize(240 + 121 + 27);  // 2.7 of 12 mm back
  specimen.force.resize(240 + 121 + 27);
  const Specimen used = prepared(specimen, smooth());
  EXPECT_THAT(used.force,
              testing::ElementsAreArray(specimen.force.begin() + 240, specimen.force.begin() + 361));
  EXPECT_THAT(used.preparation.notes,
              Contains(HasSubstr("rows 241 to 361 are fitted, the loading of cycle 2")));
}

TEST(Prepared, AHoldAtTheEndIsLeftOut) {
  Specimen specimen = pressed({});
  const std::size_t rows = specimen.size();
  const double deepest = specimen.displacement.back();
  const double force = specimen.force.back();
  for (int i = 0; i < 100; ++i) {
    specimen.displacement.push_back(deepest);
    specimen.force.push_back(force * (0.6 + 0.4 * std::exp(-0.05 * i)));
  }
  const Specimen used = prepared(specimen, smooth());
  EXPECT_EQ(used.size(), rows);
  EXPECT_THAT(used.preparation.notes, Contains(HasSubstr("--relaxation fits all")));
}

TEST(Prepared, AForceThatStopsAtTheSensorsLimitIsLeftOutFromThere) {
  Specimen specimen = pressed({});
  const double limit = 0.4 * specimen.force.back();
  const auto below = static_cast<std::size_t>(std::count_if(specimen.force.begin(), specimen.force.end(),
                                                            [limit](double force) { return force < limit; }));
  for (double& force : specimen.force) force = std::min(force, limit);
  const Specimen used = prepared(specimen, smooth());
  EXPECT_NEAR(static_cast<double>(used.size()), static_cast<double>(below), 3.0);
  EXPECT_THAT(used.preparation.notes, Contains(HasSubstr("the sensor's limit, a slip or a puncture?")));
}

TEST(Prepared, RowsSortedFromDeepToShallowAreNoLoop) {
  Specimen specimen = pressed({});
  std::reverse(specimen.displacement.begin(), specimen.displacement.end());
  std::reverse(specimen.force.begin(), specimen.force.end());
  EXPECT_EQ(prepared(specimen, smooth()).size(), specimen.size());
  EXPECT_THAT(prepared(specimen, smooth()).preparation.notes,
              ElementsAre(HasSubstr("sorted from deep to shallow. The unloading of a loop looks the same")));
  for (std::size_t i = 0; i < specimen.size(); ++i) specimen.time.push_back(0.1 * static_cast<double>(i));
  EXPECT_THAT(prepared(specimen, smooth()).preparation.notes, Contains(HasSubstr("without hysteresis")));
}

/// A tared sensor from a depth [m] to 12 mm, with noise of 1.3 % of the force range.
Specimen from_depth(double first, std::size_t rows, std::size_t rows_each, std::uint32_t number) {
  Random random(62, number, 0);
  Specimen specimen;
  const double noise = 0.013 * (exponential(12e-3) - exponential(first));
  for (std::size_t i = 0; i < rows * rows_each; ++i) {
    const double way = static_cast<double>(i / rows_each) / static_cast<double>(rows - 1);
    specimen.displacement.push_back(first + (12e-3 - first) * way);
    specimen.force.push_back(exponential(specimen.displacement.back()) + noise * random.normal());
  }
  return specimen;
}

TEST(Prepared, TheForceOfATaredSensorThatStartsAtDepthIsNoZero) {
  for (std::uint32_t n = 0; n < 20; ++n) {
    const Specimen specimen = from_depth(2e-3, 50, 1, n);
    const Specimen used = prepared(specimen, smooth());
    EXPECT_EQ(used.force, specimen.force) << n;
    EXPECT_THAT(used.preparation.notes, IsEmpty()) << n;
  }
}

TEST(Prepared, DisplacementsThatAreHeldInStepsAreNoMotionWithoutContact) {
  for (std::uint32_t n = 0; n < 20; ++n) {
    const Specimen specimen = from_depth(0.0, 13, 20, n);
    const Specimen used = prepared(specimen, smooth());
    EXPECT_EQ(used.force, specimen.force) << n;
    EXPECT_THAT(used.preparation.notes, IsEmpty()) << n;
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

}  // namespace
}  // namespace palpate::identify
