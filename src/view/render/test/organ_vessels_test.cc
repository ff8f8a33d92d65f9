#include "view/render/organ_vessels.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "palpate/builtin.h"
#include "palpate/mesh.h"

namespace palpate::render {
namespace {

Vec3 metres(const VesselKnot& knot) { return 1e-3 * Vec3(knot.x, knot.y, knot.z); }

double nearest_vertex(const geometry::TriangleMesh& mesh, const Vec3& p) {
  double nearest = 1.0;
  for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, (v - p).norm());
  return nearest;
}

std::vector<StaticVertex> painted(const std::string& organ, const geometry::TriangleMesh& mesh) {
  const TissueAppearance look = tissue_appearance("heart");
  std::vector<StaticVertex> pattern = tissue_pattern(mesh, look);
  paint_vessels(organ, mesh, look, pattern);
  return pattern;
}

// A flat square of 60 mm at the height z, 1 mm between its vertices, with normals along +z.
geometry::TriangleMesh plate(const Vec3& middle) {
  geometry::TriangleMesh mesh;
  constexpr int kSide = 61;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) mesh.vertices.emplace_back(middle + 1e-3 * Vec3(i - 30, j - 30, 0));
  for (int j = 0; j + 1 < kSide; ++j) {
    for (int i = 0; i + 1 < kSide; ++i) {
      const int a = j * kSide + i;
      mesh.triangles.push_back({a, a + 1, a + kSide});
      mesh.triangles.push_back({a + 1, a + kSide + 1, a + kSide});
    }
  }
  return mesh;
}

TEST(OrganVessels, OrgansThatHaveThemAreBuiltIn) {
  std::set<std::string_view> organs;
  for (const OrganVessel& vessel : organ_vessels()) {
    organs.insert(vessel.organ);
    EXPECT_GE(vessel.line.size(), 2U);
  }
  EXPECT_EQ(organs, (std::set<std::string_view>{"heart", "kidney", "liver"}));
}

TEST(OrganVessels, CoronaryLinesLieWithinTheirRadiusOfTheFineHeartsSurface) {
  const geometry::TriangleMesh heart = geometry::make_organ("heart-300k");
  for (const OrganVessel& vessel : organ_vessels()) {
    if (vessel.kind != VesselKind::kCoronary) continue;
    for (const VesselKnot& knot : vessel.line)
      EXPECT_LT(nearest_vertex(heart, metres(knot)), 1e-3 * (2.4 * static_cast<double>(knot.radius) + 0.6))
          << knot.x << ' ' << knot.y;
  }
}

// On a plate through the middle of the first coronary vessel, the distance to the side grows evenly from one
// side to the other, in radii.
TEST(OrganVessels, TheDistanceToTheSideIsLinearAcrossAVessel) {
  const OrganVessel& vessel = organ_vessels().front();
  ASSERT_EQ(vessel.kind, VesselKind::kCoronary);
  const VesselKnot& knot = vessel.line[vessel.line.size() / 2];
  const Vec3 along = (metres(vessel.line[vessel.line.size() / 2 + 1]) - metres(knot)).normalized();
  const std::vector<StaticVertex> pattern = painted("heart", plate(metres(knot)));
  const double turn = std::hypot(along.x(), along.y());
  int drawn = 0;
  for (const StaticVertex& vertex : pattern) {
    const Vec3 offset = vertex.rest.cast<double>() - metres(knot);
    // Nearly straight there: compare close to the knot alone.
    if (offset.norm() > 2.5e-3 || vertex.light[3] < 250) continue;
    const double lateral = (along.y() * offset.x() - along.x() * offset.y()) / turn;
    const double side = (2.0 * vertex.light[2] / 255.0 - 1.0) * 3.0;
    EXPECT_NEAR(side, lateral / (1e-3 * static_cast<double>(knot.radius)), 0.35) << offset.transpose();
    ++drawn;
  }
  EXPECT_GT(drawn, 8);
}

TEST(OrganVessels, AVesselHasFadedWhereItsSideEnds) {
  for (const StaticVertex& vertex : painted("heart", geometry::make_organ("heart"))) {
    const double side = std::abs(2.0 * vertex.light[2] / 255.0 - 1.0) * 3.0;
    if (side > 2.75) {
      EXPECT_EQ(vertex.light[3], 0) << side;
    }
  }
}

TEST(OrganVessels, TheAortaIsPaleAndTheVentricleIsNot) {
  const std::vector<StaticVertex> pattern = painted("heart-30k", geometry::make_organ("heart-30k"));
  const auto top = std::max_element(pattern.begin(), pattern.end(),
                                    [](const auto& a, const auto& b) { return a.rest.y() < b.rest.y(); });
  const auto apex = std::min_element(pattern.begin(), pattern.end(), [](const auto& a, const auto& b) {
    return a.rest.y() - a.rest.x() < b.rest.y() - b.rest.x();
  });
  EXPECT_GT(top->colour[1], 110);  // the root of linear 0.24 is 0.49
  EXPECT_LT(apex->colour[1], 90);
}

TEST(OrganVessels, AnOrganOfAFileStaysAsItsTissueIs) {
  const geometry::TriangleMesh heart = geometry::make_organ("heart");
  const std::vector<StaticVertex> plain = tissue_pattern(heart, tissue_appearance("heart"));
  for (const char* name : {"", "heart.stl", "gallbladder"}) {
    const std::vector<StaticVertex> pattern = painted(name, heart);
    for (std::size_t v = 0; v < pattern.size(); ++v) {
      ASSERT_EQ(pattern[v].colour, plain[v].colour) << name;
      ASSERT_EQ(pattern[v].light, plain[v].light) << name;
    }
  }
}

}  // namespace
}  // namespace palpate::render
