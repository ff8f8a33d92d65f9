// What describes a map best: the tissue alone, inclusions, or a map of the stiffness.
#include "fit/identify/map_choice.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/contact/stiffness_map.h"
#include "palpate/spring_law.h"

#include "fit/identify/map_tissue.h"

namespace palpate::identify {
namespace {

constexpr double kChoiceBall = 3e-3;  // m

/// A flat map of 11 x 11 probes 2 mm apart, six rows each. @param force [N] at x, y, depth [mm]
std::vector<MapRow> flat_map(const std::function<double(double, double, double)>& force) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> noise(0.0, 0.004);
  std::vector<MapRow> rows;
  for (int probe = 0; probe < 121; ++probe) {
    const double x = 2.0 * (probe % 11 - 5);
    const double y = 2.0 * (probe / 11 - 5);
    for (int step = 1; step <= 6; ++step) {
      const double depth = 0.4 * step;
      rows.push_back({probe, Vec3(1e-3 * x, 1e-3 * y, 0.0), Vec3::UnitZ(), 1e-3 * depth,
                      force(x, y, depth) + noise(random)});
    }
  }
  return rows;
}

double tissue_force(double depth) { return 0.1 * std::pow(depth, 1.4); }

DescribedMap described(const std::vector<MapRow>& rows) {
  return describe_map(rows, {kChoiceBall, 2, false});
}

double error_of(const DescribedMap& map, MapKind kind) {
  return map.held_error[static_cast<std::size_t>(kind)];
}

TEST(MapChoice, AUniformTissueIsTheTissueAloneWithoutInclusions) {
  const DescribedMap map =
      described(flat_map([](double, double, double depth) { return tissue_force(depth); }));
  EXPECT_EQ(map.won, MapKind::kTissue);
  EXPECT_EQ(map.held_out, 60U);
  EXPECT_THAT(map.fit.inclusions, testing::IsEmpty());
  EXPECT_NEAR(error_of(map, MapKind::kTissue), 0.004, 0.0004) << "the noise";
  for (const model::StiffnessPoint& one : map.fit.stiffness_map) EXPECT_NEAR(one.factor, 1.0, 0.02);
}

TEST(MapChoice, SaysByHowMuchARunDiffersWhereFirstContactIsFarFromTheFirstRows) {
  EXPECT_THAT(described(flat_map([](double, double, double depth) { return tissue_force(depth); })).warnings,
              testing::IsEmpty());
  // 1.2 mm below the surface a contact 0.5 mm higher up has (1.2 / 1.7)^1.4 = 0.61 of the force.
  EXPECT_THAT(
      described(flat_map([](double, double, double depth) { return tissue_force(depth + 0.5); })).warnings,
      testing::ElementsAre(testing::AllOf(testing::HasSubstr("mm above the first rows"),
                                          testing::HasSubstr("1.2 mm deep it gives 39 % less force"))));
}

TEST(MapChoice, AnInclusionOfTheLawIsDescribedByInclusions) {
  const model::InclusionLaw law(3e-3, 5e-3, 20.0);
  const DescribedMap map = described(flat_map([&law](double x, double y, double depth) {
    const double uniform = tissue_force(depth);
    const model::InclusionLaw::Extra extra =
        law.at(model::PressedTip(kChoiceBall, 1e-3 * depth), 1e-6 * (x * x + y * y));
    return uniform * (1.0 + extra.energy) + uniform * 1e-3 * depth / 2.4 * extra.by_depth;
  }));
  EXPECT_EQ(map.won, MapKind::kLumps);
  ASSERT_EQ(map.fit.inclusions.size(), 1U);
  EXPECT_NEAR(map.fit.inclusions[0].centre[0].value, 0.0, 0.3e-3);
  EXPECT_NEAR(error_of(map, MapKind::kLumps), 0.004, 0.001) << "the noise";
}

TEST(MapChoice, AStiffnessWithoutInclusionsIsDescribedByAMap) {
  const auto wave = [](double x, double y) { return std::exp(0.8 * std::sin(0.45 * x) * std::cos(0.4 * y)); };
  const DescribedMap map = described(
      flat_map([&wave](double x, double y, double depth) { return wave(x, y) * tissue_force(depth); }));
  EXPECT_TRUE(map.won == MapKind::kStiffness || map.won == MapKind::kLumpsAndStiffness);
  EXPECT_LT(error_of(map, MapKind::kStiffness), 0.5 * error_of(map, MapKind::kTissue));
  // Places between the probes.
  std::vector<MapRow> between;
  for (int i = 0; i < 9; ++i) {
    between.push_back({1000 + i, Vec3(1e-3 * (2 * i - 7), 1e-3, 0.0), Vec3::UnitZ(), 2e-3, 0.0});
  }
  const std::vector<double> forces = predicted_forces(map.predictor, between, between);
  for (int i = 0; i < 9; ++i) {
    const double expected = wave(2 * i - 7, 1.0) * tissue_force(2.0);
    EXPECT_NEAR(forces[static_cast<std::size_t>(i)], expected, 0.08 * expected) << i;
  }
}

TEST(MapChoice, ARiseBeyondTheLawIsPredictedBetterWithAMapThanByInclusions) {
  const DescribedMap map = described(flat_map([](double x, double y, double depth) {
    return tissue_force(depth) * (1.0 + 14.0 * depth / 2.4 * std::exp(-(x * x + y * y) / 12.5));
  }));
  EXPECT_TRUE(map.won == MapKind::kStiffness || map.won == MapKind::kLumpsAndStiffness);
  EXPECT_LT(error_of(map, map.won), error_of(map, MapKind::kLumps));
  EXPECT_EQ(map.fit.inclusions.empty(), !map.left_out.empty()) << "found, or left out";
}

TEST(MapChoice, TooFewProbesHoldNoneOut) {
  std::vector<MapRow> rows = flat_map([](double, double, double depth) { return tissue_force(depth); });
  rows.resize(12 * 6);
  EXPECT_EQ(described(rows).held_out, 0U);
}

TEST(FactorField, GoesThroughItsPointsAndIsTheirConstantFarAway) {
  const std::vector<model::StiffnessPoint> points = {
      {Vec3(0, 0, 0), 2.0}, {Vec3(4e-3, 0, 0), 0.5}, {Vec3(0, 5e-3, 0), 1.5}, {Vec3(3e-3, 3e-3, 0), 1.0}};
  const FactorField field(points, 1e-9);
  for (const model::StiffnessPoint& one : points) EXPECT_NEAR(field.at(one.point_S), one.factor, 1e-6);
  const FactorField same(std::vector<model::StiffnessPoint>{{Vec3(0, 0, 0), 3.0}, {Vec3(4e-3, 0, 0), 3.0}});
  EXPECT_NEAR(same.at(Vec3(0.05, 0.02, 0.0)), 3.0, 1e-9);
  EXPECT_EQ(FactorField().at(Vec3(1, 2, 3)), 1.0);
}

TEST(FactorField, APointWithoutItselfIsTheFieldOfTheOthers) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(-0.01, 0.01);
  std::vector<model::StiffnessPoint> points;
  for (int i = 0; i < 12; ++i)
    points.push_back({Vec3(at(random), at(random), 0.0), std::exp(60.0 * at(random))});
  const FactorField field(points, 0.05);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<model::StiffnessPoint> others = points;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_NEAR(field.without(i), FactorField(others, 0.05).at(points[i].point_S), 1e-9);
  }
}

/// A box with a grid of vertices 1 mm apart on its top face z = 0; the other faces are coarse.
geometry::TriangleMesh box_with_fine_top(int cells) {
  geometry::TriangleMesh mesh;
  const double half = 0.5e-3 * cells;
  const auto index = [cells](int i, int j) { return static_cast<std::int32_t>(j * (cells + 1) + i); };
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) mesh.vertices.emplace_back(1e-3 * i - half, 1e-3 * j - half, 0.0);
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  const auto bottom = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0, 0.0, -40e-3);
  for (int i = 0; i < cells; ++i) {
    mesh.triangles.push_back({index(i + 1, 0), index(i, 0), bottom});
    mesh.triangles.push_back({index(i, cells), index(i + 1, cells), bottom});
    mesh.triangles.push_back({index(0, i), index(0, i + 1), bottom});
    mesh.triangles.push_back({index(cells, i + 1), index(cells, i), bottom});
  }
  return mesh;
}

TEST(FactorField, IsTheStiffnessMapOfAnOrganOnAFlatFace) {
  constexpr double kReference = 10e-3;  // m, radius
  const contact::OrganSurface organ(box_with_fine_top(80), kReference);
  std::vector<model::StiffnessPoint> points;
  for (int i = 0; i < 25; ++i) {
    const double x = 4.0 * (i % 5 - 2);
    const double y = 4.0 * (i / 5 - 2);
    points.push_back({Vec3(1e-3 * x, 1e-3 * y, 0.0), std::exp(-(x * x + y * y) / 60.0) + 1.0});
  }
  const contact::StiffnessMap map(organ, points);
  const FactorField field(points);
  for (const auto& [x, y] : {std::pair(2.0, 2.0), std::pair(-6.0, 2.0), std::pair(1.0, 5.0)}) {
    const Vec3 at(1e-3 * x, 1e-3 * y, 0.0);
    const geometry::NearestPoint nearest = organ.nearest(at, -1);
    EXPECT_NEAR(field.at(at), map.factor_at({nearest.point, nearest.triangle}).value, 0.02) << x << ' ' << y;
  }
}

TEST(MapTissue, ASmoothTissueIsNearThePowerLawOfTheBackground) {
  FittedMap map;
  map.tip_radius = kChoiceBall;
  map.first_depth = 0.2e-3;
  map.uniform = [](double depth) {
    return std::pair(tissue_force(1e3 * depth), tissue_force(1e3 * depth) * depth / 2.4);
  };
  const MapTissue made = tissue_of_map(map, 2.4e-3);
  EXPECT_LT(made.error, 0.02);
  const model::SpringLaw law(made.tissue, model::Direction::kPress, 1e-3);
  for (const double mm : {0.3, 1.0, 2.0, 2.6}) {
    EXPECT_NEAR(law.force_at(1e-3 * mm).force, tissue_force(mm), 0.02 * tissue_force(2.6)) << mm;
  }
}

}  // namespace
}  // namespace palpate::identify
