#include "view/render/display_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/deform/surface_parts.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/surface.h"
#include "view/render/organ_picture.h"

namespace palpate::render {
namespace {

RefineRule shorter_than(double edge) {
  return {50.0, [edge](const Vec3&, double length, double) { return length > edge; }};
}

bool closed(const geometry::TriangleMesh& mesh) {
  const auto neighbours = geometry::edge_neighbours(mesh);
  return std::all_of(neighbours.begin(), neighbours.end(), [](const auto& of_triangle) {
    return std::all_of(of_triangle.begin(), of_triangle.end(), [](std::int32_t n) { return n >= 0; });
  });
}

TEST(RefineSmoothly, MakesACoarseBallRound) {
  const double radius = 0.03;
  const geometry::TriangleMesh coarse = geometry::make_ball(radius, 320);
  const geometry::TriangleMesh fine = refine_smoothly(coarse, shorter_than(0.002));
  EXPECT_TRUE(closed(fine));
  for (const Vec3& v : fine.vertices) EXPECT_NEAR(v.norm(), radius, 0.002 * radius);
  // The flat triangles lie up to 1 - cos(9 degrees) = 1.2 % of the radius inside the sphere.
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(fine.vertices[v], coarse.vertices[v]);
}

TEST(RefineSmoothly, LeavesABoxABox) {
  const Vec3 size(0.06, 0.05, 0.04);
  const geometry::TriangleMesh fine = refine_smoothly(geometry::make_box(size, 1.0), shorter_than(0.003));
  EXPECT_TRUE(closed(fine));
  EXPECT_NEAR(geometry::signed_volume(fine), 0.06 * 0.05 * 0.04, 1e-12);
  for (const Vec3& v : fine.vertices)
    EXPECT_NEAR((v.cwiseAbs().cwiseQuotient(0.5 * size)).maxCoeff(), 1.0, 1e-12);
}

TEST(RefineSmoothly, LeavesNoEdgeThatIsToBeSplit) {
  const geometry::TriangleMesh fine = refine_smoothly(geometry::make_ball(0.02, 80), shorter_than(0.003));
  for (const geometry::Triangle& t : fine.triangles) {
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 edge = fine.vertices[static_cast<std::size_t>(t[e])] -
                        fine.vertices[static_cast<std::size_t>(t[(e + 1) % 3])];
      EXPECT_LE(edge.norm(), 0.003);
    }
  }
}

TEST(RefineSmoothly, StaysClosedWhereOnlyAPartIsDivided) {
  const RefineRule near_top{
      50.0, [](const Vec3& middle, double length, double) { return middle.z() > 0.01 && length > 0.001; }};
  const geometry::TriangleMesh fine = refine_smoothly(geometry::make_ball(0.02, 320), near_top);
  EXPECT_TRUE(closed(fine));
  EXPECT_GT(fine.triangles.size(), 2000U);
}

TEST(CleanCreases, ThoseOfABoxAreCleanThoseOfACoarseLiverAreNot) {
  EXPECT_TRUE(has_clean_creases(geometry::make_box(Vec3(0.04, 0.04, 0.04), 1.0), 50.0));
  EXPECT_TRUE(has_clean_creases(geometry::make_box(Vec3(0.06, 0.05, 0.04), 0.005), 50.0));
  EXPECT_FALSE(has_clean_creases(geometry::make_organ("liver"), 50.0));
}

TEST(NarrowCreases, NormalsOfABoxTurnWithinTheBandAlone) {
  geometry::TriangleMesh box =
      refine_smoothly(geometry::make_box(Vec3(0.04, 0.04, 0.04), 1.0), shorter_than(0.004));
  narrow_creases(box, 50.0, 1e-4);
  EXPECT_TRUE(closed(box));
  EXPECT_NEAR(geometry::signed_volume(box), 0.04 * 0.04 * 0.04, 1e-12);
  const std::vector<Vec3> normals = deform::vertex_normals(box);
  double turning = 0.0;  // m^2, area of the triangles whose corners' normals differ
  for (const geometry::Triangle& t : box.triangles) {
    const auto at = [&t](const auto& of, std::size_t k) { return of[static_cast<std::size_t>(t[k])]; };
    if (at(normals, 0).dot(at(normals, 1)) > 0.999 && at(normals, 0).dot(at(normals, 2)) > 0.999) continue;
    turning +=
        0.5 *
        (at(box.vertices, 1) - at(box.vertices, 0)).cross(at(box.vertices, 2) - at(box.vertices, 0)).norm();
  }
  EXPECT_LE(turning, 12 * 0.04 * 2 * 1e-4);  // twelve edges, a band on both sides
}

TEST(EvenOut, MovesNoVertexByMoreThanTheLimitAndNoSharpOne) {
  geometry::TriangleMesh box =
      refine_smoothly(geometry::make_box(Vec3(0.04, 0.04, 0.04), 1.0), shorter_than(0.004));
  for (std::size_t v = 0; v < box.vertices.size(); ++v)
    box.vertices[v] *= 1.0 + 0.002 * std::sin(static_cast<double>(v));
  const geometry::TriangleMesh before = box;
  smooth_bumps(box, 5e-5, 50.0);
  double largest = 0.0;
  for (std::size_t v = 0; v < box.vertices.size(); ++v)
    largest = std::max(largest, (box.vertices[v] - before.vertices[v]).norm());
  EXPECT_LE(largest, 5e-5 * (1.0 + 1e-9));
  EXPECT_GT(largest, 1e-5);
  for (std::size_t v = 0; v < 8; ++v) EXPECT_EQ(box.vertices[v], before.vertices[v]);
}

TEST(VertexNormals, AreRadialOnABall) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.02, 1280);
  const std::vector<Vec3> normals = deform::vertex_normals(ball);
  for (std::size_t v = 0; v < normals.size(); ++v)
    EXPECT_GT(normals[v].dot(ball.vertices[v].normalized()), 0.999);
}

TEST(CornerNormals, KeepTheEdgesOfABoxSharp) {
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.02, 0.02, 0.02), 0.01);
  const std::vector<Vec3> normals = corner_normals(box, 40.0);
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    const Vec3 own = geometry::area_vector_doubled(box, box.triangles[t]).normalized();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(normals[3 * t + k].dot(own), 1.0, 1e-12);
  }
}

TEST(MeanEdge, IsTheMean) {
  const geometry::TriangleMesh one{{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 4, 0)}, {{0, 1, 2}}};
  EXPECT_NEAR(mean_edge(one), 4.0, 1e-12);
  EXPECT_EQ(mean_edge({}), 0.0);
}

haptics::Snapshot with_view(double depth) {
  haptics::Snapshot snapshot;
  snapshot.hands = 1;
  snapshot.results[0].view_count = 1;
  contact::ContactView& view = snapshot.results[0].views[0];
  view.point_S = Vec3(0, 0, 0.03);
  view.direction_S = -Vec3::UnitZ();
  view.depth = depth;
  view.tip_radius = 0.003;
  return snapshot;
}

TEST(OrganPicture, MovesTheSurfaceUnderTheContactByTheDepth) {
  OrganPicture organ(geometry::make_ball(0.03, 1280), {});
  organ.update(deform::indentations_of(with_view(0.010).hand_results()));
  double lowest = 1.0;
  for (const deform::SurfaceVertex& vertex : organ.vertices()) {
    const Vec3 v = vertex.position.cast<double>();
    if (std::hypot(v.x(), v.y()) < 0.0007 && v.z() > 0.0) lowest = std::min(lowest, v.z());
  }
  EXPECT_NEAR(lowest, 0.020, 0.0002);
}

TEST(OrganPicture, DividesFinelyAroundAContactOnceAndNotAgain) {
  OrganPicture organ(geometry::make_ball(0.03, 1280), {});
  const std::size_t before = organ.rest().triangles.size();
  EXPECT_TRUE(organ.update(deform::indentations_of(with_view(0.002).hand_results())));
  EXPECT_GT(organ.rest().triangles.size(), before + 1000);
  EXPECT_FALSE(organ.update(deform::indentations_of(with_view(0.008).hand_results())));
  EXPECT_FALSE(organ.update({}));
  EXPECT_TRUE(closed(organ.rest()));
}

/// [m] of edges whose triangles meet at more than 50 degrees.
double sharp_length(const geometry::TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, Vec3> first;  // normal of an edge's first triangle
  double sum = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 normal = geometry::area_vector_doubled(mesh, t).normalized();
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [a, b] = std::minmax(t[e], t[(e + 1) % 3]);
      const auto [entry, fresh] = first.try_emplace({a, b}, normal);
      if (fresh || normal.dot(entry->second) > std::cos(50.0 * std::numbers::pi / 180.0)) continue;
      sum += (mesh.vertices[static_cast<std::size_t>(a)] - mesh.vertices[static_cast<std::size_t>(b)]).norm();
    }
  }
  return sum;
}

TEST(OrganPicture, RoundsTheMarginOfACoarseLiverAndKeepsTheEdgesOfABox) {
  const geometry::TriangleMesh liver = geometry::make_organ("liver");
  ASSERT_GT(sharp_length(liver), 0.1);
  EXPECT_LT(sharp_length(OrganPicture(liver, {}).rest()), 0.25 * sharp_length(liver));
  const geometry::TriangleMesh box = geometry::make_box(Vec3(0.04, 0.04, 0.04), 1.0);
  EXPECT_NEAR(sharp_length(OrganPicture(box, {}).rest()), 12 * 0.04, 1e-9);
}

TEST(IndexedCorners, AreTheGivenCornersInTheirOrder) {
  const ToolPicture tool(geometry::make_tool("curved-forceps"));
  const std::vector<deform::SurfaceVertex> corners = tool.corners(0);
  const IndexedCorners indexed = indexed_corners(corners);
  ASSERT_EQ(indexed.corners.size(), corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(indexed.vertices.at(indexed.corners[i]).position, corners[i].position);
    EXPECT_EQ(indexed.vertices.at(indexed.corners[i]).normal, corners[i].normal);
  }
}

TEST(IndexedCorners, ShareVerticesWhereTheSurfaceIsSmooth) {
  const std::vector<deform::SurfaceVertex> corners = ToolPicture(geometry::make_tool("sphere:3")).corners(0);
  // A closed mesh has about a sixth as many vertices as corners; some normals differ in their last bit.
  EXPECT_LT(indexed_corners(corners).vertices.size(), corners.size() / 5);
}

}  // namespace
}  // namespace palpate::render
