#include "fit/identify/sweep.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "fit/identify/test/springs.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kQ = 2;
constexpr std::size_t kLimit = 3;

/// Two layers: 20 N/m up to 4 mm, then 100 N/m up to 8 mm; noise of 2 mN.
Specimen bent(std::uint32_t number) { return springs({}, number); }

ManyFits fits_of(const std::vector<Specimen>& specimens) {
  tasks::Communicator alone;
  return fit_many(specimens, Settings{}, alone, "", {});
}

Sweeps sweeps_of(const std::vector<Specimen>& specimens, const ManyFits& fits, const std::string& request) {
  tasks::Communicator alone;
  return sweep_many(specimens, fits, sweep_requests("--sweep", request), Settings{}, alone, "", {});
}

/// The error message for a line with `point`; "" when the line is valid.
std::string refused(const std::string& values, const std::string& point) {
  const std::string line =
      R"({"best_nrmse":0.1,"found_better":false,"values":)" + values + R"(,"points_swept":[)" + point + "]}";
  Sweep sweep;
  try {
    add_sweep_line(line, sweep);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SweepLine, WithoutItsPointsTheirParametersOrAWholeNumberOfThemIsRefused) {
  const std::string point = "[1,0.2,1.0,0.5,1,2,3,4]";
  EXPECT_EQ(refused("1", point), "");
  EXPECT_EQ(refused("2", point), "sweep's line: has fewer points than values");
  EXPECT_EQ(refused("1", "[1,0.2,1.0,0.5,1,2,3]"), "sweep's line: a point lacks parameters");
  EXPECT_EQ(refused("1e30", point), "values is 1e+30, want a whole number from 0 to 18446744073709551615");
  EXPECT_EQ(refused("-1", point), "values is -1, want a whole number from 0 to 18446744073709551615");
}

TEST(SweepLine, AParameterOfTheLawThatIsNotGreaterThanZeroIsRefused) {
  EXPECT_EQ(refused("1", "[0.0,0.2,1.0,0.5,1,2,3,4]"), "sweep's line: a parameter is 0.0, want a number > 0");
  EXPECT_EQ(refused("1", "[1,0.2,1.0,0.5,1,2,-3,4]"), "sweep's line: a parameter is -3, want a number > 0");
  EXPECT_EQ(refused("1", "[1,0.2,1.0,0.5,1,2,3,4,0.0]"), "");  // relaxation parameters may be 0
}

TEST(Sweep, AParameterThatTheDataTellIsBoundedOnBothSides) {
  const std::vector<Specimen> specimens = {bent(1)};
  const ManyFits fits = fits_of(specimens);
  const Sweeps sweeps = sweeps_of(specimens, fits, "limit_mm=1.5:9:25");
  ASSERT_EQ(sweeps.all.size(), 1U);  // one specimen: no pooled sweep
  const Sweep& sweep = sweeps.all.front();
  EXPECT_EQ(sweep.specimen, "bent 1");
  EXPECT_EQ(sweep.parameter, kLimit);
  ASSERT_GE(sweep.points.size(), 26U);  // 25, and the value of the fit
  EXPECT_FALSE(sweep.open_below);
  EXPECT_FALSE(sweep.open_above);
  EXPECT_FALSE(sweep.found_better);
  EXPECT_NEAR(sweep.points.front().value, 1.5e-3, 1e-9);
  EXPECT_NEAR(sweep.points.back().value, 9e-3, 1e-9);
  for (const SweepPoint& point : sweep.points) {
    EXPECT_GE(point.nrmse, sweep.best_nrmse * (1.0 - 1e-3)) << point.value;
    EXPECT_NEAR(point.others[kLimit], point.value, 1e-12);
    const Interval& interval = fits.specimens.front().estimates[kLimit].interval;
    // the interval contains each value of the confidence set; its end is accurate to a tenth of its length
    const bool inside = point.value > 0.95 * interval.low && point.value < 1.05 * interval.high;
    EXPECT_TRUE(inside || !point.within_95) << point.value;
  }
}

// A corner of the law that passes a data point makes a local optimum. The fits of these two curves once ended
// in one of them, up to 4 % above the global one.
TEST(Sweep, NoValueFitsBetterThanTheFitOfACurveWithManyMinima) {
  for (const std::uint32_t number : {5U, 12U}) {
    const std::vector<Specimen> specimens = {bent(number)};
    const Sweep sweep = sweeps_of(specimens, fits_of(specimens), "k1_N_per_m=18:22:41").all.front();
    EXPECT_FALSE(sweep.found_better) << number;
    for (const SweepPoint& point : sweep.points) {
      EXPECT_GT(point.deviance, -0.1) << number << ' ' << point.value;
    }
  }
}

TEST(Sweep, NoValueFitsClearlyBetterThanTheFitOfRandomSprings) {
  for (std::uint32_t number = 0; number < 3; ++number) {
    const std::vector<Specimen> specimens = {springs(random_springs(number), number)};
    for (const Sweep& sweep : sweeps_of(specimens, fits_of(specimens), "all").all) {
      EXPECT_FALSE(sweep.found_better) << number << ' ' << sweep.parameter;
    }
  }
}

/// RMS error, divided by the force range, of the best o + k max(0, d - c) for c up to `farthest`: least
/// squares in o and k for each of 400 values of c.
double best_spring(const Specimen& specimen, double farthest) {
  const auto n = static_cast<double>(specimen.size());
  double least = 1e300;
  for (int step = -200; step <= 200; ++step) {
    const double contact = farthest * step / 200.0;
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t i = 0; i < specimen.size(); ++i) {
      const double depth = std::max(0.0, specimen.displacement[i] - contact);
      x += depth / n;
      y += specimen.force[i] / n;
      xx += depth * depth / n;
      xy += depth * specimen.force[i] / n;
      yy += specimen.force[i] * specimen.force[i] / n;
    }
    least = std::min(least, yy - y * y - (xy - x * y) * (xy - x * y) / (xx - x * x));
  }
  const auto [weak, strong] = std::minmax_element(specimen.force.begin(), specimen.force.end());
  return std::sqrt(least) / (*strong - *weak);
}

// With L_1 = 12 mm, beyond all data, one spring remains. Its first contact may move by a quarter of the
// range, and its prior limits it.
TEST(Sweep, TheErrorIsThatOfTheBestCurveWithThatValue) {
  const Specimen specimen = bent(2);
  const Sweeps sweeps = sweeps_of({specimen}, fits_of({specimen}), "limit_mm=2:12:3");
  const double nrmse = sweeps.all.front().points.back().nrmse;
  EXPECT_GT(nrmse, 0.99 * best_spring(specimen, 2e-3));
  EXPECT_LT(nrmse, 1.01 * best_spring(specimen, 0.0));
}

// A thin soft first layer, between 4 and 5 N/m, fits this curve nearly as well as 21 N/m.
TEST(Sweep, FindsWhatTheDataLeaveBetweenItsValues) {
  const std::vector<Specimen> specimens = {bent(12)};
  const ManyFits fits = fits_of(specimens);
  for (const char* request : {"k1_N_per_m=0.5:60:12", "k1_N_per_m=0.5:60:16", "k1_N_per_m=0.5:60:24"}) {
    const Sweep sweep = sweeps_of(specimens, fits, request).all.front();
    const auto left = std::find_if(sweep.points.begin(), sweep.points.end(),
                                   [](const SweepPoint& point) { return point.within_95; });
    ASSERT_NE(left, sweep.points.end()) << request;
    EXPECT_GT(left->value, 4.0) << request;
    EXPECT_LT(left->value, 5.0) << request;
  }
}

TEST(Sweep, AgreesWithIntervalsOnMinimaFarFromTheBest) {
  for (std::uint32_t number = 0; number < 3; ++number) {  // one has an optimum near 4.3 N/m that the data
                                                          // reject
    const std::vector<Specimen> specimens = {bent(number)};
    const ManyFits fits = fits_of(specimens);
    EXPECT_GT(fits.specimens.front().estimates[0].interval.low, 18.0) << number;
    const Sweeps sweeps = sweeps_of(specimens, fits, "k1_N_per_m=3:6:15");
    for (const SweepPoint& point : sweeps.all.front().points) {
      EXPECT_FALSE(point.within_95) << number << ' ' << point.value;
    }
  }
}

TEST(Sweep, AParameterThatNoDataTellStaysOpenAtBothEnds) {
  std::vector<Specimen> specimens;
  for (std::uint32_t n = 0; n < 2; ++n) {
    specimens.push_back(bent(n));
    for (std::size_t i = 0; i < specimens.back().size(); ++i) {
      const double depth = specimens.back().displacement[i];
      if (depth > 4e-3) specimens.back().force[i] -= 80.0 * (depth - 4e-3);  // 20 N/m throughout
    }
  }
  const Sweeps sweeps = sweeps_of(specimens, fits_of(specimens), "q=0.1:2.5:9");
  ASSERT_EQ(sweeps.all.size(), 3U);  // one for each, then the pooled one
  EXPECT_EQ(sweeps.all[2].specimen, "");
  for (const Sweep& sweep : sweeps.all) {
    EXPECT_EQ(sweep.parameter, kQ);
    EXPECT_TRUE(sweep.open_below) << sweep.specimen;
    EXPECT_TRUE(sweep.open_above) << sweep.specimen;
  }
}

TEST(Sweep, OfAllTogetherIsBoundedByHowSpecimensDiffer) {
  const std::vector<Specimen> specimens = {bent(1), bent(2), bent(3), bent(4)};
  const ManyFits fits = fits_of(specimens);
  const Sweep sweep = sweeps_of(specimens, fits, "limit_mm=1.5:9:15").all.back();
  EXPECT_FALSE(sweep.open_below);
  EXPECT_FALSE(sweep.open_above);
  EXPECT_TRUE(std::isnan(sweep.points.front().deviance));
  EXPECT_NEAR(sweep.best, fits.pooled.estimates[kLimit].value, 0.0);
  EXPECT_NEAR(sweep.best_nrmse, fits.pooled.nrmse, 1e-9);
}

TEST(Sweep, GoesOnWhereABrokenOffRunWas) {
  const palpate::test::TemporaryFolder folder;
  const std::string file = (folder.path() / "fits.jsonl").string();
  const std::vector<Specimen> specimens = {bent(1)};
  const ManyFits fits = fits_of(specimens);
  const std::vector<ParameterSweep> requests = sweep_requests("--sweep", "q=0.3:1:5");
  tasks::Communicator alone;
  const Sweeps whole = sweep_many(specimens, fits, requests, Settings{}, alone, file, {});
  EXPECT_EQ(whole.resumed, 0U);
  std::string text;
  {
    std::ifstream in(file);
    std::getline(in, text);  // terminates a line that might have been cut off
    std::getline(in, text);
  }
  std::ofstream(file, std::ios::trunc) << text << "\n{\"key\": \"cut o";
  const Sweeps again = sweep_many(specimens, fits, requests, Settings{}, alone, file, {});
  EXPECT_EQ(again.resumed, 1U);
  ASSERT_EQ(again.all.front().points.size(), whole.all.front().points.size());
  for (std::size_t i = 0; i < whole.all.front().points.size(); ++i) {
    EXPECT_EQ(again.all.front().points[i].nrmse, whole.all.front().points[i].nrmse);
    EXPECT_EQ(again.all.front().points[i].others, whole.all.front().points[i].others);
  }
  EXPECT_THROW((void)sweep_many(specimens, fits, requests, Settings{}, alone, "/nowhere/f", {}), InputError);
  EXPECT_THROW((void)sweep_many({}, fits, requests, Settings{}, alone, "", {}), InputError);
}

TEST(Sweep, OfFewValuesOverAWideRangeHasTheFitsOwnAndOneBesideItThatTheDataLeave) {
  const std::vector<Specimen> specimens = {bent(12)};
  const ManyFits fits = fits_of(specimens);
  const Sweep sweep = sweeps_of(specimens, fits, "k1_N_per_m=1:1000:3").all.front();
  const auto own = std::find_if(sweep.points.begin(), sweep.points.end(), [&](const SweepPoint& point) {
    return std::abs(point.value / sweep.best - 1.0) < 1e-9;
  });
  ASSERT_NE(own, sweep.points.end());
  EXPECT_TRUE(own->within_95);
  EXPECT_TRUE((own - 1)->within_95);
  EXPECT_TRUE((own + 1)->within_95);
}

TEST(Sweep, ComputesAgainWhatALineOfTheResultsFileLacks) {
  const palpate::test::TemporaryFolder folder;
  const std::string file = (folder.path() / "fits.jsonl").string();
  const std::vector<Specimen> specimens = {bent(1)};
  const ManyFits fits = fits_of(specimens);
  const std::vector<ParameterSweep> requests = sweep_requests("--sweep", "q=0.3:2:5");
  tasks::Communicator alone;
  const Sweeps whole = sweep_many(specimens, fits, requests, Settings{}, alone, file, {});
  std::string emptied;
  {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      emptied +=
          line.substr(0, line.find("\"points_swept\":")) + (line.empty() ? "\n" : "\"points_swept\":[]}\n");
    }
  }
  std::ofstream(file, std::ios::trunc) << emptied;
  const Sweeps again = sweep_many(specimens, fits, requests, Settings{}, alone, file, {});
  EXPECT_EQ(again.resumed, 0U);
  EXPECT_EQ(again.all.front().points.size(), whole.all.front().points.size());
}

TEST(Sweep, RefusesLinesThatSayThemselvesThatTheyHaveNoValues) {
  const palpate::test::TemporaryFolder folder;
  const std::string file = (folder.path() / "fits.jsonl").string();
  const std::vector<Specimen> specimens = {bent(1)};
  const ManyFits fits = fits_of(specimens);
  const std::vector<ParameterSweep> requests = sweep_requests("--sweep", "q=0.3:1:3");
  tasks::Communicator alone;
  (void)sweep_many(specimens, fits, requests, Settings{}, alone, file, {});
  std::string emptied;
  {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      if (line.empty()) continue;
      emptied += line.substr(0, line.find("\"values\":")) + "\"values\":0,\"points_swept\":[]}\n";
    }
  }
  std::ofstream(file, std::ios::trunc) << emptied;
  EXPECT_THAT(
      [&] { (void)sweep_many(specimens, fits, requests, Settings{}, alone, file, {}); },
      ::testing::ThrowsMessage<InputError>(
          file + ": the sweep of bent 1: q has 0 points, must have 3: delete the file to repeat the sweep"));
}

TEST(Sweep, RefusesARangeFarBeyondWhatAFitSearches) {
  const std::vector<Specimen> specimens = {bent(1)};
  ManyFits fits;
  fits.specimens.resize(1);
  try {
    (void)sweeps_of(specimens, fits, "k1_N_per_m=1e-300:1e300:3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("--sweep k1_N_per_m=1e-300:1e+300: must lie between "));
  }
}

TEST(Sweep, RequestsAreReadInTheParametersUnit) {
  const ParameterSweep request = sweep_requests("--sweep", "limit_mm=2:9:15").front();
  EXPECT_EQ(request.parameter, kLimit);
  EXPECT_NEAR(*request.low, 2e-3, 1e-15);
  EXPECT_NEAR(*request.high, 9e-3, 1e-15);
  EXPECT_EQ(request.values, 15U);
  EXPECT_FALSE(sweep_requests("--sweep", "beta").front().low.has_value());
  EXPECT_EQ(sweep_requests("--sweep", "k1_N_per_m=5:50").front().values, 21U);
  EXPECT_EQ(sweep_requests("--sweep", "all").size(), 4U);
}

TEST(Sweep, RefusesOtherRequestsNamingWhatWouldBeRight) {
  for (const char* text :
       {"", "k1", "q=", "q=1", "q=2:1", "q=0:1", "q=-1:1", "q=1:1", "q=0.5:0.9:2", "q=0.5:0.9:1001",
        "q=0.5:0.9:7.5", "q=0.5:0.9:7:8", "q=0.5:inf", "q=nan:1", "all=1:2", "q=a:b", "q =1:2"}) {
    EXPECT_THROW((void)sweep_requests("--sweep", text), InputError) << text;
  }
  try {
    (void)sweep_requests("--sweep", "k1=1:2");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("--sweep k1=1:2: must be k1_N_per_m, beta, q, limit_mm"));
  }
}

}  // namespace
}  // namespace palpate::identify
