#include "fit/identify/fit_many.h"

#include <fstream>
#include <limits>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "fit/identify/fit_record.h"

namespace palpate::identify {
namespace {

/// F = 0.05 (exp(d/4 mm) - 1) N up to 12 mm in 24 points, with 1 % noise.
Specimen measured_curve(std::uint32_t number) {
  Random random(5, number, 0);
  Specimen specimen;
  specimen.name = "curve " + std::to_string(number);
  for (int i = 1; i <= 24; ++i) {
    const double depth = 0.5e-3 * i;
    specimen.displacement.push_back(depth);
    specimen.force.push_back(0.05 * (std::exp(depth / 4e-3) - 1.0) * (1.0 + 0.01 * random.normal()));
  }
  return specimen;
}

SpecimenFit plain_fit() {
  SpecimenFit fit;
  fit.name = "an \"odd\" name\n";
  fit.law = model::LawKind::kSmooth;
  fit.layers_allowed = 6;
  fit.layers_reached = 4;
  fit.estimates.resize(6);
  fit.estimates[0].value = 0.1 + 0.2;  // 17 digits
  fit.estimates[0].interval = {-std::numeric_limits<double>::infinity(), 1e-310};
  fit.estimates[1].covariance = Interval{1.0 / 3.0, 2.0 / 3.0};
  fit.estimates[2].bootstrap = Interval{-0.0, std::numeric_limits<double>::quiet_NaN()};
  fit.estimates[2].determined = false;
  fit.rms = 1e-300;
  fit.points = 7;
  fit.rows = 9;
  fit.warnings = {"one", "two"};
  fit.curve.displacement = {1e-3, 2e-3};
  fit.curve.measured = {0.1, 0.2};
  fit.curve.fitted = {0.11, 0.19};
  fit.curve.low = {0.10, 0.18};
  fit.curve.high = {0.12, 0.21};
  fit.shared = {1.0, 2.0, 3.0, 4.0};
  fit.own = {5.0, 6.0};
  return fit;
}

std::vector<std::string> lines_in(const std::string& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

TEST(FitRecord, ReadsBackToTheBit) {
  const SpecimenFit fit = plain_fit();
  const SpecimenFit back = parse_record_line(record_line("key", fit));
  EXPECT_EQ(record_line("key", back), record_line("key", fit));
  EXPECT_EQ(back.name, fit.name);
  EXPECT_EQ(back.law, fit.law);
  EXPECT_EQ(back.estimates[0].value, 0.1 + 0.2);
  EXPECT_EQ(back.estimates[0].interval.low, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(back.estimates[0].interval.high, 1e-310);
  EXPECT_FALSE(back.estimates[0].covariance.has_value());
  EXPECT_EQ(back.estimates[1].covariance->high, 2.0 / 3.0);
  EXPECT_TRUE(std::signbit(back.estimates[2].bootstrap->low));
  EXPECT_TRUE(std::isnan(back.estimates[2].bootstrap->high));
  EXPECT_TRUE(back.estimates[1].determined);
  EXPECT_FALSE(back.estimates[2].determined);
  EXPECT_EQ(back.rms, 1e-300);
  EXPECT_EQ(back.own, fit.own);
}

TEST(FitRecord, RefusesWhatIsNoWholeLine) {
  const std::string line = record_line("key", plain_fit());
  EXPECT_THROW((void)parse_record_line(line.substr(0, line.size() / 2)), InputError);
  EXPECT_THROW((void)parse_record_line("{}"), InputError);
  EXPECT_THROW((void)doubles_of("seven b"), InputError);
  EXPECT_THROW((void)specimens_of("short"), InputError);
}

TEST(FitRecord, RefusesACurveWithColumnsOfDifferentLength) {
  for (const auto column :
       {&Curve::time, &Curve::displacement, &Curve::measured, &Curve::fitted, &Curve::low, &Curve::high}) {
    SpecimenFit fit = plain_fit();
    (fit.curve.*column).push_back(0.1);
    EXPECT_THROW((void)parse_record_line(record_line("key", fit)), InputError);
  }
}

TEST(FitRecord, ACountThatIsNoWholeNumberIsRefusedByName) {
  const std::string plain = record_line("key", plain_fit());
  for (const std::string count : {"layers", "layers_reached", "terms", "points", "rows"}) {
    const std::string field = '"' + count + "\":";
    const std::string line = std::regex_replace(plain, std::regex(field + "\\d+"), field + "1e30");
    EXPECT_THAT([&] { (void)parse_record_line(line); },
                ::testing::ThrowsMessage<InputError>(
                    ::testing::StartsWith(count + " is 1e+30, want a whole number")));
  }
}

TEST(FitRecord, AKeyChangesWithDataFlagsAndNumber) {
  const Specimen specimen = measured_curve(1);
  const Settings settings;
  const std::string key = record_key(specimen, settings, 0);
  EXPECT_EQ(record_key(specimen, settings, 0), key);
  Specimen other = specimen;
  other.force[3] = std::nextafter(other.force[3], 1.0);
  EXPECT_NE(record_key(other, settings, 0), key);
  Settings more = settings;
  more.bootstrap = 1;
  EXPECT_NE(record_key(specimen, more, 0), key);
  EXPECT_NE(record_key(specimen, settings, 1), key);
}

TEST(FitRecord, SpecimensGoBetweenRanksUnchanged) {
  std::vector<Specimen> specimens = {measured_curve(1), measured_curve(2)};
  specimens[1].time = {0.5, 1.5};
  specimens[1].tip_radius = 3e-3;
  const std::vector<Specimen> back = specimens_of(bytes_of(specimens));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].name, "curve 1");
  EXPECT_EQ(back[1].time, specimens[1].time);
  EXPECT_EQ(back[1].tip_radius, 3e-3);
  EXPECT_EQ(back[0].force, specimens[0].force);
}

TEST(FitMany, GoesOnWhereABrokenOffRunWas) {
  const palpate::test::TemporaryFolder folder;
  const std::string file = (folder.path() / "fits.jsonl").string();
  const std::vector<Specimen> specimens = {measured_curve(1), measured_curve(2)};
  Settings settings;
  settings.bootstrap = 2;
  tasks::Communicator alone;
  const ManyFits whole = fit_many(specimens, settings, alone, file, {});
  EXPECT_EQ(whole.resumed, 0U);
  const std::vector<std::string> lines = lines_in(file);
  ASSERT_EQ(lines.size(), 2U);
  std::ofstream(file, std::ios::trunc) << lines[1] << '\n' << lines[0].substr(0, lines[0].size() / 3);
  const ManyFits again = fit_many(specimens, settings, alone, file, {});
  EXPECT_EQ(again.resumed, 1U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(record_line("", again.specimens[i]), record_line("", whole.specimens[i])) << i;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(again.pooled.estimates[i].interval.low, whole.pooled.estimates[i].interval.low) << i;
  }
}

TEST(FitMany, NamesASpecimenThatCannotBeFitted) {
  Specimen few = measured_curve(1);
  few.force.resize(4);
  few.displacement.resize(4);
  tasks::Communicator alone;
  EXPECT_THROW((void)fit_many({few}, Settings{}, alone, "", {}), InputError);
  EXPECT_THROW((void)fit_many({measured_curve(1)}, Settings{}, alone, "/nowhere/fits.jsonl", {}), InputError);
}

TEST(Random, SkipsAsManyAsWereAsked) {
  Random drawn(3, 1, 2);
  for (int i = 0; i < 7; ++i) (void)drawn.uniform();
  Random skipped(3, 1, 2);
  skipped.skip(7);
  EXPECT_EQ(skipped.uniform(), drawn.uniform());
}

}  // namespace
}  // namespace palpate::identify
