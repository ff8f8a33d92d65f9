#include "fit/identify/size_exponent.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::identify {
namespace {

/// Hertz's ball on tissue of E = 6 kPa, nu = 0.5: F = 16/9 E sqrt(R) D^1.5, to 4 mm, with noise of 0.5 % of
/// the range. @param stiffer factor of this specimen
Specimen hertz(double radius, double stiffer, std::uint32_t number) {
  constexpr double kModulus = 6e3;
  constexpr double kDeepest = 4e-3;
  Random random(5, number, 0);
  Specimen specimen;
  specimen.name = "ball " + std::to_string(number);
  specimen.tip_radius = radius;
  const auto force = [&](double depth) {
    return stiffer * 16.0 / 9.0 * kModulus * std::sqrt(radius) * std::pow(depth, 1.5);
  };
  for (int i = 1; i <= 40; ++i) {
    const double depth = kDeepest * i / 40;
    specimen.displacement.push_back(depth);
    specimen.force.push_back(force(depth) + 0.005 * force(kDeepest) * random.normal());
  }
  return specimen;
}

Settings ball_settings() {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  return settings;
}

std::vector<SpecimenFit> ball_fits(const std::vector<Specimen>& specimens) {
  std::vector<SpecimenFit> fits;
  for (const Specimen& specimen : specimens) {
    fits.push_back(fit_specimen(specimen, ball_settings(), static_cast<std::uint32_t>(fits.size()), {}));
  }
  return fits;
}

TEST(SizeExponent, OfHertzsBallsIsAHalfAndTheTissueIsThatOfTheReferenceBall) {
  const std::vector<Specimen> specimens = {hertz(2e-3, 1.1, 0),  hertz(2e-3, 0.92, 1), hertz(4e-3, 1.05, 2),
                                           hertz(4e-3, 0.94, 3), hertz(8e-3, 1.04, 4), hertz(8e-3, 0.95, 5)};
  const std::vector<SpecimenFit> fits = ball_fits(specimens);
  const PooledFit pooled = fit_pooled(specimens, fits, ball_settings(), {});
  ASSERT_TRUE(pooled.size.has_value());
  const SizeExponent& size = *pooled.size;
  EXPECT_NEAR(size.value, 0.5, 0.05);
  EXPECT_LT(size.interval.low, 0.5);
  EXPECT_GT(size.interval.high, 0.5);
  EXPECT_LT(size.interval.high - size.interval.low, 0.4);
  EXPECT_TRUE(size.determined);
  EXPECT_EQ(size.reference_radius, 4e-3);
  EXPECT_EQ(pooled.tissue.size_exponent, size.value);
  EXPECT_EQ(pooled.tissue.source->radius, 4e-3);
  EXPECT_NO_THROW(model::validate(pooled.tissue));
  EXPECT_LT(pooled.nrmse, 0.08);  // the specimens differ by 10 %; by a factor 2 without the exponent
  std::vector<Specimen> nameless = specimens;
  for (Specimen& specimen : nameless) specimen.tip_radius = 0.0;
  EXPECT_GT(fit_pooled(nameless, fits, ball_settings(), {}).nrmse, 2.0 * pooled.nrmse);
}

TEST(SizeExponent, OfTwoSpecimensHasNoInterval) {
  const std::vector<Specimen> specimens = {hertz(2e-3, 1.0, 0), hertz(8e-3, 1.0, 1)};
  const std::optional<SizeExponent> size =
      fit_size_exponent(specimens, ball_fits(specimens), ball_settings());
  ASSERT_TRUE(size.has_value());
  EXPECT_NEAR(size->value, 0.5, 0.05);
  EXPECT_FALSE(size->determined);
  EXPECT_EQ(size->interval.low, 0.0);
  EXPECT_EQ(size->interval.high, 2.0);
  EXPECT_THAT(undetermined_size(*size), testing::HasSubstr("three specimens or more"));
}

TEST(SizeExponent, OfAlikeIndentersIsNotFittedButTheirRadiusIsTheSource) {
  const std::vector<Specimen> specimens = {hertz(4e-3, 1.0, 0), hertz(4.5e-3, 1.0, 1)};
  const std::vector<SpecimenFit> fits = ball_fits(specimens);
  const PooledFit pooled = fit_pooled(specimens, fits, ball_settings(), {});
  EXPECT_FALSE(pooled.size.has_value());
  EXPECT_EQ(pooled.tissue.size_exponent, 0.0);
  EXPECT_TRUE(pooled.tissue.source.has_value());
  EXPECT_EQ(fit_pooled({specimens[0]}, {fits[0]}, ball_settings(), {}).tissue.source->radius, 4e-3);
}

TEST(SizeExponent, IsRefusedWhereOnlySomeSpecimensHaveARadius) {
  std::vector<Specimen> specimens = {hertz(2e-3, 1.0, 0), hertz(8e-3, 1.0, 1)};
  specimens[1].tip_radius = 0.0;
  try {
    (void)fit_size_exponent(specimens, ball_fits(specimens), ball_settings());
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ball 1: has no indenter_radius_mm"));
  }
}

TEST(ReadSpecimens, RowsOfAnotherIndenterAreAnotherSpecimen) {
  const palpate::test::TemporaryFolder folder;
  std::string text = "displacement_mm,force_N,indenter_radius_mm\n";
  for (const std::string radius : {"3", "6.5"}) {
    for (int i = 0; i < 12; ++i) text += std::to_string(i) + "," + std::to_string(i) + "e-2," + radius + '\n';
  }
  const std::vector<Specimen> all = read_specimens(folder.write("two.csv", text));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_DOUBLE_EQ(all[0].tip_radius, 3e-3);
  EXPECT_DOUBLE_EQ(all[1].tip_radius, 6.5e-3);
  EXPECT_EQ(all[1].size(), 12U);
}

TEST(ReadSpecimens, RefusesARadiusThatNoIndenterHas) {
  const palpate::test::TemporaryFolder folder;
  for (const auto& [cell, want] : {std::pair{"0", "must be > 0"}, std::pair{"0.0004", "is it in mm"}}) {
    const auto file = folder.write(
        "bad.csv", std::string("displacement_mm,force_N,indenter_radius_mm\n1,0.1,") + cell + '\n');
    try {
      (void)read_specimens(file);
      FAIL() << "accepted " << cell;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(want));
      EXPECT_THAT(error.what(), testing::HasSubstr("bad.csv:2: indenter_radius_mm"));
    }
  }
}

}  // namespace
}  // namespace palpate::identify
