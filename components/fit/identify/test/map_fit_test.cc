// Fits of palpation maps: synthetic maps with known inclusions, and measured phantoms if PALPATE_DATA has
// them.
#include "fit/identify/map_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "io/system/test/not_tested.h"
#include "palpate/error.h"

#include "fit/identify/map_model.h"
#include "fit/identify/map_problem.h"

namespace palpate::identify {
namespace {

constexpr double kMapBall = 5e-3;     // m
constexpr double kMapSpacing = 4e-3;  // m, between the probes of a square grid
constexpr int kMapSide = 9;           // probes along a side

struct TrueLump {
  double x, y, depth, radius, ratio;
};

/// A flat map whose forces are those of the law, with noise relative to the force. The background is Hertz's.
std::vector<MapRow> synthetic_map(const std::vector<TrueLump>& lumps, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<MapRow> rows;
  const double middle = 0.5 * (kMapSide - 1) * kMapSpacing;
  for (int probe = 0; probe < kMapSide * kMapSide; ++probe) {
    const Vec3 point(kMapSpacing * (probe % kMapSide) - middle, kMapSpacing * (probe / kMapSide) - middle,
                     0.0);
    for (int step = 1; step <= 8; ++step) {
      const double depth = 0.6e-3 * step;
      const double uniform = 900.0 * std::pow(depth, 1.5);
      double factor = 1.0;
      double rise = 0.0;
      for (const TrueLump& lump : lumps) {
        const double square = std::pow(point.x() - lump.x, 2) + std::pow(point.y() - lump.y, 2);
        const model::InclusionLaw law(lump.radius, lump.depth, lump.ratio);
        const model::InclusionLaw::Extra extra = law.at(model::PressedTip(kMapBall, depth), square);
        factor *= 1.0 + extra.energy;
        rise += extra.by_depth / (1.0 + extra.energy);
      }
      const double force = factor * (uniform + 0.4 * uniform * depth * rise);
      rows.push_back({probe, point, Vec3::UnitZ(), depth, force * (1.0 + noise * normal(random))});
    }
  }
  return rows;
}

std::vector<TrueLump> random_lumps(std::size_t count, std::mt19937_64& random) {
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<TrueLump> lumps;
  while (lumps.size() < count) {
    TrueLump one{between(-13e-3, 13e-3), between(-13e-3, 13e-3), 0.0, between(3e-3, 5e-3),
                 between(8.0, 50.0)};
    one.depth = one.radius + between(1e-3, 3e-3);
    bool apart = true;
    for (const TrueLump& other : lumps) apart = apart && std::hypot(one.x - other.x, one.y - other.y) > 13e-3;
    if (apart) lumps.push_back(one);
  }
  return lumps;
}

/// Number of maps of a test; PALPATE_MAPS sets another one for a longer run.
int maps_of_test(int usual) {
  const char* more = std::getenv("PALPATE_MAPS");
  return more == nullptr ? usual : std::max(1, std::atoi(more));
}

MapSettings quick_settings() {
  MapSettings settings;
  settings.tip_radius = kMapBall;
  settings.max_inclusions = 4;
  settings.profiles = false;
  return settings;
}

TEST(MapFit, InclusionsAreFoundWithinTwoMillimetresAndTheirIntervalsHold) {
  std::mt19937_64 random(21);
  const int maps = maps_of_test(2);
  int lumps = 0;
  int missed = 0;
  int extra = 0;
  int held = 0;
  for (int i = 0; i < maps; ++i) {
    const std::vector<TrueLump> truth = random_lumps(static_cast<std::size_t>(1 + i % 3), random);
    const MapFit fit = fit_map(synthetic_map(truth, 0.05, random), quick_settings());
    lumps += static_cast<int>(truth.size());
    extra += std::max(0, static_cast<int>(fit.inclusions.size()) - static_cast<int>(truth.size()));
    for (const TrueLump& one : truth) {
      const FoundInclusion* nearest = nullptr;
      double distance = 2e-3;
      for (const FoundInclusion& found : fit.inclusions) {
        const double away = std::hypot(found.centre[0].value - one.x, found.centre[1].value - one.y);
        if (away > distance) continue;
        distance = away;
        nearest = &found;
      }
      if (nearest == nullptr) {
        ++missed;
        continue;
      }
      const auto holds = [](const Interval& interval, double value) {
        return interval.low <= value && value <= interval.high ? 1 : 0;
      };
      held += holds(nearest->centre[0].interval, one.x) + holds(nearest->centre[1].interval, one.y);
    }
  }
  std::cout << maps << " maps: " << lumps << " lumps, " << missed << " missed, " << extra << " false, "
            << 50.0 * held / std::max(1, lumps - missed) << " % of the intervals hold\n";
  EXPECT_EQ(missed, 0);
  EXPECT_LE(extra, lumps / 20);
  EXPECT_GE(held, static_cast<int>(0.85 * 2 * (lumps - missed)));
}

TEST(MapFit, AUniformMapHasNoInclusion) {
  std::mt19937_64 random(5);
  const int maps = maps_of_test(2);
  int found = 0;
  for (int i = 0; i < maps; ++i) {
    found += static_cast<int>(fit_map(synthetic_map({}, 0.05, random), quick_settings()).inclusions.size());
  }
  std::cout << maps << " maps: " << found << " false\n";
  EXPECT_LE(found, maps / 20);
}

TEST(MapFit, AnIntervalOfARatioEndsWhereTheSumOfSquaresHasGrownByItsShare) {
  std::mt19937_64 random(6);
  MapSettings settings = quick_settings();
  settings.profiles = true;
  settings.max_inclusions = 1;
  const std::vector<MapRow> rows = synthetic_map({{1e-3, 2e-3, 8e-3, 5e-3, 3.0}}, 0.001, random);
  const MapFit fit = fit_map(rows, settings);
  ASSERT_EQ(fit.inclusions.size(), 1U);
  const Values weights = weights_of(rows);
  const MapProblem map(rows, settings, fit.map_terms, weights);
  const double least = map.sum_of_squares(fit.values);
  const std::size_t ratio = map.model().first_inclusion() + kLogRatio;
  for (const double end : {fit.inclusions[0].ratio.interval.low, fit.inclusions[0].ratio.interval.high}) {
    ASSERT_TRUE(std::isfinite(end) && end > 0.1);
    Values held = fit.values;
    held[ratio] = std::log(end);
    const double sum = map.sum_of_squares(solve_map(map, held, ratio, 500));
    // 3.84: the 95 % quantile of chi-squared with one degree of freedom
    EXPECT_NEAR(std::sqrt((sum / least - 1.0) * static_cast<double>(rows.size() - held.size()) / 3.84), 1.0,
                0.1);
  }
}

TEST(MapFit, AValueAtItsBoundTakesNoPartInTheStepsOfTheOthers) {
  std::mt19937_64 random(8);
  // Three lumps at one place ask for more than the ratio 100 of one.
  const TrueLump lump{1e-3, 2e-3, 9e-3, 5e-3, 100.0};
  const std::vector<MapRow> rows = synthetic_map({lump, lump, lump}, 0.01, random);
  const Values weights = weights_of(rows);
  const MapProblem map(rows, quick_settings(), 1, weights);
  const std::size_t ratio = map.model().first_inclusion() + kLogRatio;
  const Values start = {
      std::log(900.0 * std::pow(1e-3, 1.5)), 1.5, 0.1, 1.5, 2.0, 9.0, std::log(5.0 / 9.0), std::log(100.0)};
  constexpr int kSteps = 4;
  const Values found = solve_map(map, start, std::nullopt, kSteps);
  const Values held = solve_map(map, start, ratio, kSteps);
  ASSERT_GT(std::abs(held[3] - start[3]), 0.1);  // mm: it took steps
  for (std::size_t k = 0; k < held.size(); ++k) EXPECT_NEAR(found[k], held[k], 1e-6) << k;
}

TEST(MapFit, ASmallHardInclusionIsSaidNotToBeDeterminedApartFromALargeSoftOne) {
  std::mt19937_64 random(3);
  MapSettings settings = quick_settings();
  settings.profiles = true;
  settings.max_inclusions = 1;
  const MapFit fit = fit_map(synthetic_map({{1e-3, 2e-3, 7e-3, 4e-3, 30.0}}, 0.05, random), settings);
  ASSERT_EQ(fit.inclusions.size(), 1U);
  EXPECT_FALSE(fit.inclusions[0].ratio.determined);
  EXPECT_LE(fit.inclusions[0].ratio.interval.low, 30.0);
  EXPECT_GE(fit.inclusions[0].ratio.interval.high, 30.0);
}

/// Largest difference of the slopes of a map's model from central differences of its forces, relative to the
/// largest slope by the same value.
double farthest_slope(const MapModel& model, std::vector<double> values, const std::vector<MapRow>& rows) {
  const std::vector<double> slopes = model.slopes(values, rows);
  double farthest = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    constexpr double kStep = 1e-5;
    const double there = values[k];
    values[k] = there + kStep;
    const std::vector<double> above = model.forces(values, rows);
    values[k] = there - kStep;
    const std::vector<double> below = model.forces(values, rows);
    values[k] = there;
    double largest = 0.0;
    double difference = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double expected = (above[i] - below[i]) / (2.0 * kStep);
      largest = std::max(largest, std::abs(expected));
      difference = std::max(difference, std::abs(slopes[i * values.size() + k] - expected));
    }
    EXPECT_GT(largest, 0.0) << "value " << k;
    farthest = std::max(farthest, difference / largest);
  }
  return farthest;
}

/// A probe on a curved surface at each point of a grid, with rows of several depths.
std::vector<MapRow> curved_map() {
  std::vector<MapRow> rows;
  for (int probe = 0; probe < 49; ++probe) {
    const double x = 4e-3 * (probe % 7 - 3);
    const double y = 4e-3 * (probe / 7 - 3);
    const double height = -5.0 * (x * x + 0.5 * y * y);
    for (const double depth : {0.5e-3, 1.5e-3, 3e-3}) {
      rows.push_back({probe, Vec3(x, y, height), Vec3(10.0 * x, 5.0 * y, 1.0), depth, 0.1});
    }
  }
  return rows;
}

TEST(MapModel, SlopesAreThoseOfTheForces) {
  const std::vector<MapRow> rows = curved_map();
  const MapModel model(rows, kMapBall, 6);
  std::vector<double> values{-2.0, 1.4, 0.3, 0.1, -0.2, 0.05, 0.1, -0.1};  // tissue and polynomial
  for (const double own : {2.1, 3.3, 6.0, -0.6, 2.5, -5.2, 1.4, 9.0, -0.4, -1.2}) values.push_back(own);
  EXPECT_LT(farthest_slope(model, values, rows), 1e-5);
}

TEST(MapModel, SlopesAreThoseOfTheForcesWhereTheirFactorIsCapped) {
  const std::vector<MapRow> rows = curved_map();
  const MapModel model(rows, kMapBall, 1);
  std::vector<double> values{-2.0, 1.4, 0.3};
  for (const double own : {0.5, 0.4, 4.0, -0.05, 4.0, 1.5, -0.6, 4.5, -0.05, 4.0}) values.push_back(own);
  double largest = 0.0;  // force over that of the tissue
  const std::vector<double> forces = model.forces(values, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    largest = std::max(largest, forces[i] / model.background(values, rows[i]));
  }
  EXPECT_GT(largest, model::kUncappedFactor);
  EXPECT_LT(farthest_slope(model, values, rows), 1e-5);
}

/// A map whose middle is `factor` times as stiff at the deepest row: more than the law of inclusions gives.
std::vector<MapRow> map_with_a_steep_bell(double factor) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0.0, 0.004);
  std::vector<MapRow> rows;
  for (int probe = 0; probe < 121; ++probe) {
    const Vec3 point(2e-3 * (probe % 11 - 5), 2e-3 * (probe / 11 - 5), 0.0);
    for (int step = 1; step <= 6; ++step) {
      const double mm = 0.4 * step;
      const double bell = std::exp(-point.squaredNorm() / (2.0 * 2.5e-3 * 2.5e-3));
      const double force = 0.1 * std::pow(mm, 1.4) * (1.0 + (factor - 1.0) * mm / 2.4 * bell);
      rows.push_back({probe, point, Vec3::UnitZ(), mm * 1e-3, force + noise(random)});
    }
  }
  return rows;
}

TEST(MapFit, AnInclusionThatEndsAtABoundIsUndeterminedAndHasNoInterval) {
  MapSettings settings = quick_settings();
  settings.tip_radius = 3e-3;
  settings.max_inclusions = 1;
  settings.profiles = true;
  const MapFit fit = fit_map(map_with_a_steep_bell(15.0), settings);
  ASSERT_EQ(fit.inclusions.size(), 1U);
  const FoundInclusion& found = fit.inclusions[0];
  EXPECT_THAT(found.at_bounds, testing::Contains("radius_mm"));
  EXPECT_NEAR(found.centre[0].value, 0.0, 0.5e-3);
  EXPECT_NEAR(found.centre[1].value, 0.0, 0.5e-3);
  for (const Estimate& one : {found.centre[0], found.centre[1], found.centre[2], found.depth, found.rise,
                              found.radius, found.ratio}) {
    EXPECT_FALSE(one.determined);
    EXPECT_TRUE(std::isinf(one.interval.low) && std::isinf(one.interval.high));
  }
}

TEST(MapFit, AnInclusionWithinTheBoundsHasFiniteIntervalsOfItsPlace) {
  std::mt19937_64 random(3);
  MapSettings settings = quick_settings();
  settings.max_inclusions = 1;
  const MapFit fit = fit_map(synthetic_map({{1e-3, 2e-3, 7e-3, 4e-3, 30.0}}, 0.05, random), settings);
  ASSERT_EQ(fit.inclusions.size(), 1U);
  EXPECT_THAT(fit.inclusions[0].at_bounds, testing::IsEmpty());
  EXPECT_LT(fit.inclusions[0].depth.interval.high, 40e-3);
  EXPECT_LT(fit.inclusions[0].rise.interval.high, 2.0);
}

TEST(MapFit, AFileIsReadWithOrWithoutNormalsAndRefusedWithItsLine) {
  const scene::test::TemporaryFolder folder;
  const auto good = folder.write("a.csv", "probe,x_mm,y_mm,z_mm,depth_mm,force_N\n7,1,2,3,0.5,0.25\n");
  const std::vector<MapRow> rows = read_map(good);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].probe, 7);
  EXPECT_NEAR((rows[0].point - Vec3(1e-3, 2e-3, 3e-3)).norm(), 0.0, 1e-15);
  EXPECT_EQ(rows[0].normal, Vec3(0, 0, 0));
  EXPECT_NEAR(rows[0].depth, 0.5e-3, 1e-15);
  const auto bad = folder.write("b.csv", "probe,x_mm,y_mm,z_mm,depth_mm,force_N\n1.5,1,2,3,0.5,0.25\n");
  EXPECT_THAT(scene::test::error_of([&] { (void)read_map(bad); }),
              testing::HasSubstr("b.csv:2: probe = 1.5"));
  EXPECT_THROW((void)fit_map(rows, quick_settings()), InputError) << "too few probes";
}

std::vector<MapRow> phantom(const std::string& name) {
  const char* data = std::getenv("PALPATE_DATA");
  if (data == nullptr) return {};
  const std::string file = std::string(data) + "/measured/phantom_lumps/" + name;
  if (!std::ifstream(file)) return {};
  return read_map(file);
}

double percent_of_range(const MapFit& fit, const std::vector<MapRow>& fitted, const MapSettings& settings,
                        const std::vector<MapRow>& rows) {
  const std::vector<double> forces =
      MapModel(fitted, settings.tip_radius, fit.map_terms).forces(fit.values, rows);
  double sum = 0.0;
  double low = 1e9;
  double high = -1e9;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    sum += std::pow(forces[i] - rows[i].force, 2);
    low = std::min(low, rows[i].force);
    high = std::max(high, rows[i].force);
  }
  return 100.0 * std::sqrt(sum / static_cast<double>(rows.size())) / (high - low);
}

TEST(PhantomMap, EverySecondProbeOfAPhantomPredictsTheOthersNearItsLump) {
  const std::vector<MapRow> all = phantom("weak_lumps.csv");
  if (all.empty()) {
    test::not_tested("PALPATE_DATA is not set");
    return;
  }
  std::vector<MapRow> fitted;
  std::vector<MapRow> near;
  for (const MapRow& row : all) {
    if (row.probe % 2 == 0) {
      fitted.push_back(row);
    } else if (std::hypot(row.point.x() + 31.4e-3, row.point.y() - 65.4e-3) < 6e-3) {
      near.push_back(row);
    }
  }
  MapSettings settings = quick_settings();
  settings.tip_radius = 3.16e-3;
  const MapFit fit = fit_map(fitted, settings);
  const double error = percent_of_range(fit, fitted, settings, near);
  std::cout << fit.inclusions.size() << " inclusions; held-out probes near the lump: " << error << " %\n";
  EXPECT_LE(error, 3.0);
}

TEST(PhantomMap, ASecondRunOverAStrandIsPredictedFromTheFirst) {
  const std::vector<MapRow> first = phantom("stiff_strand_run1.csv");
  const std::vector<MapRow> second = phantom("stiff_strand_run2.csv");
  if (first.empty() || std::getenv("PALPATE_MAPS") == nullptr) {
    test::not_tested("PALPATE_DATA and PALPATE_MAPS are not set; it takes minutes");
    return;
  }
  MapSettings settings = quick_settings();
  settings.tip_radius = 3.16e-3;
  settings.max_inclusions = 6;
  const MapFit fit = fit_map(first, settings);
  std::cout << fit.inclusions.size()
            << " inclusions; run 2: " << percent_of_range(fit, first, settings, second) << " %\n";
}

}  // namespace
}  // namespace palpate::identify
