// Warnings about fits, and fits that give no tissue.
#include "fit/identify/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
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
#include "fit/identify/test/pressed.h"

namespace palpate::identify {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

// 4 mm of a rising lead, which --law layered fits as tissue, then a curve that no layers have.
TEST(FitSpecimen, AveragedPointsAreComparedWithTheNoiseOfAverages) {
  Random random(63, 0, 0);
  Specimen specimen;
  for (int i = 0; i < 12000; ++i) {
    const double at = 1e-6 * i;
    specimen.displacement.push_back(at);
    specimen.force.push_back(10.0 * at + exponential(at - 4e-3) + 20e-3 * random.normal());
  }
  const SpecimenFit fit = fit_specimen(specimen, Settings{}, 0, {});
  EXPECT_LT(fit.rms, 1.3 * 20e-3);                    // below the noise of a row,
  EXPECT_GT(fit.rms, 1.3 * 20e-3 / std::sqrt(12.0));  // above that of 12 rows
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("the law does not follow the rest")));
}

// A spring of 100 N/m: at 6 of 12 mm the force is uncertain by e / 6 mm when first contact is by e.
TEST(FitSpecimen, NamesTheUncertaintyOfTheForceOverTwoPercentInTheDeeperHalf) {
  for (const double noise : {0.0, 20e-3}) {
    Random random(64, 0, 0);
    Specimen specimen;
    for (int i = 0; i <= 120; ++i) {
      specimen.displacement.push_back(1e-4 * i);
      specimen.force.push_back(100.0 * 1e-4 * i + noise * random.normal());
    }
    const SpecimenFit fit = fit_specimen(specimen, Settings{}, 0, {});
    const auto found = std::find_if(fit.warnings.begin(), fit.warnings.end(), [](const std::string& warning) {
      return warning.find("makes first contact uncertain") != std::string::npos;
    });
    ASSERT_EQ(found != fit.warnings.end(), noise > 0.0);
    if (noise == 0.0) continue;
    double contact = 0.0;  // mm
    double depth = 0.0;    // mm
    double share = 0.0;    // %
    ASSERT_EQ(std::sscanf(found->c_str(),
                          "noise in the first rows makes first contact uncertain by %lf mm or more, and the "
                          "force at %lf mm by %lf %% or more",
                          &contact, &depth, &share),
              3);
    EXPECT_NEAR(depth, 6.0, 0.2);
    EXPECT_GT(contact, 0.0);
    EXPECT_NEAR(share, 100.0 * contact / 6.0, 1.5);
  }
}

// 12 rows with 1 % of noise allow other laws. Where rows show first contact, its place is the only question.
TEST(FitSpecimen, SaysHowFarTheForceDiffersAmongTheLawsThatTheDataAllow) {
  Random random(65, 0, 0);
  Specimen few;
  for (int i = 0; i < 12; ++i) {
    few.displacement.push_back(1e-3 * i);
    few.force.push_back(exponential(1e-3 * i) + 0.02 * random.normal());
  }
  const auto said = Contains(HasSubstr("other laws and first contacts fit the rows as well"));
  EXPECT_THAT(fit_specimen(few, smooth(), 0, {}).warnings, said);
  EXPECT_THAT(fit_specimen(pressed({4e-3, 0.0, 0.0}), smooth(), 0, {}).warnings, testing::Not(said));
}

// 6 mm of air and a sensor tilted by 2 mN/mm: to some noise a soft tissue from the first row on fits as well.
TEST(NoTissue, ATiltThatASoftTissueExplainsAsWellGivesNoTissue) {
  for (const std::uint32_t n : {1U, 3U, 51U}) {
    const SpecimenFit fit = fit_specimen(pressed({6e-3, 0.0, 2.0}, n), smooth(), 0, {});
    const bool right = std::abs(force_at_ten(fit) / kAtTenMillimetres - 1.0) < 0.02;
    EXPECT_EQ(right, n == 1);
    EXPECT_EQ(right, fit.poor.empty()) << n << ": " << force_at_ten(fit);
    if (n == 51) {
      EXPECT_THAT(fit.poor, HasSubstr("other laws and first contacts fit the rows as well")) << "touch later";
    }
  }
}

// The layered law does not follow these curves. It takes the air for tissue, and its force at 10 mm is less
// than half of the right one; the smooth law leaves less than an eighth of its error.
TEST(NoTissue, ATiltThatThisLawFitsWorseThanTheOtherGivesNoTissue) {
  for (const Fault& fault : {Fault{6e-3, 0.0, 2.0}, {6e-3, 0.0, 20.0}, {3e-3, 0.0, 2.0}}) {
    const SpecimenFit fit = fit_specimen(pressed(fault, 1), Settings{}, 0, {});
    EXPECT_LT(force_at_ten(fit), 0.5 * kAtTenMillimetres);
    EXPECT_THAT(fit.poor, HasSubstr("give no tissue"));
    EXPECT_THAT(fit.poor, HasSubstr("fit --law smooth")) << fault.slope;
  }
}

// 6.8 mm of air, then a law that reaches 33 N at 12 mm. Noise of 32 mN hides its first layer, so the rows
// show contact only to a millimetre.
TEST(NoTissue, RowsThatShowContactButNotTheLawGiveNoTissue) {
  const Point shared{std::log(17.0), std::log(1.89), std::log(0.594), std::log(5.31e-3)};
  const model::SmoothSpringLaw law(tissue_of(shared, smooth()), model::Direction::kPress, 1e-3);
  Random random(71, 1, 0);
  Specimen specimen;
  for (int i = 0; i <= 250; ++i) {
    const double at = 18.8e-3 / 250 * i;
    specimen.displacement.push_back(at);
    specimen.force.push_back(law.force_at(std::max(0.0, at - 6.8e-3)).force + 0.032 * random.normal());
  }
  const SpecimenFit fit = fit_specimen(specimen, smooth(), 0, {});
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("taken as motion without contact")));
  EXPECT_THAT(fit.poor, HasSubstr("give no tissue: other laws and first contacts fit the rows as well"));
}

// 6 mm of air in noise of 30 mN. The sensor is tared.
TEST(NoTissue, FlatRowsThatMayBeAirGiveNoTissue) {
  Random random(67, 0, 0);
  Specimen specimen;
  for (int i = 0; i <= 60; ++i) {
    specimen.displacement.push_back(0.3e-3 * i);
    specimen.force.push_back(exponential(0.3e-3 * i - 6e-3) + 0.03 * random.normal());
  }
  EXPECT_THAT(fit_specimen(specimen, smooth(), 0, {}).poor,
              HasSubstr("give no tissue: the force does not rise out of the noise"));
}

// A parabola that begins at contact, which the layered law does not follow exactly: laws that reach less deep
// say nothing about depths below their last row.
TEST(FitSpecimen, TheUncertaintyOfTheForceEndsWithTheRows) {
  Specimen specimen;
  for (int i = 0; i < 30; ++i) {
    specimen.displacement.push_back(0.2e-3 * i);
    specimen.force.push_back(0.05 * i + 0.001 * i * i);
  }
  const SpecimenFit fit = fit_specimen(specimen, Settings{}, 0, {});
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("other laws and first contacts fit the rows as well")));
  EXPECT_THAT(fit.warnings, testing::Each(testing::Not(HasSubstr("over 100 %"))));
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

TEST(FitPooled, RefusesAFitWithALargerErrorThanTheForceRange) {
  const Specimen specimen = pressed({});
  SpecimenFit fit = fit_specimen(specimen, smooth(), 0, {});
  fit.nrmse = 1.2;
  try {
    (void)fit_pooled({specimen}, {fit}, smooth(), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("specimen pressed has an error of 120.0 % of the force range, must be at "
                          "most 100 %"));
    EXPECT_THAT(error.what(), HasSubstr("tare the sensor before contact"));
  }
}

TEST(PoorFit, NamesTheWorstSpecimenOrThatGoodSpecimensDiffer) {
  std::vector<SpecimenFit> fits(2);
  PooledFit pooled;
  for (const double good : {0.1, kPoorFit}) {
    fits[1].nrmse = pooled.nrmse = good;
    EXPECT_EQ(poor_fit(fits, pooled), "");
  }
  pooled.nrmse = 0.20001;
  EXPECT_EQ(
      poor_fit(fits, pooled),
      "the fit of all specimens together has an error of 20.1 % of the force range, must be at most 20 %: "
      "the specimens differ");
  fits[1].name = "b";
  fits[1].nrmse = 0.203;
  pooled.nrmse = 0.5;
  EXPECT_EQ(
      poor_fit(fits, pooled),
      "the fit of specimen b has an error of 20.3 % of the force range, must be at most 20 %: the data do "
      "not have the law's shape");
}

}  // namespace
}  // namespace palpate::identify
