#include "palpate/mesh.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/cell.h"
#include "palpate/error.h"
#include "palpate/tool.h"

namespace palpate::geometry {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

int boundary_edges(const TriangleMesh& mesh) {
  int count = 0;
  for (const auto& around : edge_neighbours(mesh)) {
    for (const std::int32_t neighbour : around) count += neighbour < 0 ? 1 : 0;
  }
  return count;
}

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& triangle : mesh.triangles) sum += 0.5 * area_vector_doubled(mesh, triangle).norm();
  return sum;
}

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 edge = mesh.vertices[static_cast<std::size_t>(triangle[e])] -
                        mesh.vertices[static_cast<std::size_t>(triangle[(e + 1) % 3])];
      longest = std::max(longest, edge.norm());
    }
  }
  return longest;
}

/// 1 for an equilateral triangle, near 0 for a sliver: 4 sqrt(3) area / sum of squared edges.
double worst_shape(const TriangleMesh& mesh) {
  double worst = 1.0;
  for (const Triangle& triangle : mesh.triangles) {
    double squares = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      squares += (mesh.vertices[static_cast<std::size_t>(triangle[e])] -
                  mesh.vertices[static_cast<std::size_t>(triangle[(e + 1) % 3])])
                     .squaredNorm();
    }
    worst = std::min(worst, 2.0 * std::sqrt(3.0) * area_vector_doubled(mesh, triangle).norm() / squares);
  }
  return worst;
}

TEST(CellAt, CountsCellsFromTheOriginDownwards) {
  EXPECT_EQ(cell_at({0.0, 0.0199, -0.0001}, 0.01), (Cell{0, 1, -1}));
  EXPECT_EQ(cell_at({-0.02, 1.0, 40.0}, 0.5), (Cell{-1, 2, 80}));
}

TEST(CellAt, OfAFilesLargestNumbersHasNeighboursToo) {
  const std::int64_t outermost = std::int64_t{1} << 62;
  EXPECT_EQ(cell_at({3.4e38, -3.4e38, 1e300}, 1e-9), (Cell{outermost, -outermost, outermost}));
}

TEST(Mesh, BoundsOfNothingAreZero) {
  const Bounds box = bounds({});
  EXPECT_EQ(box.low, Vec3::Zero());
  EXPECT_EQ(box.high, Vec3::Zero());
}

TEST(Mesh, BoundsSizeAndMiddle) {
  TriangleMesh mesh;
  mesh.vertices = {{1, -2, 3}, {-1, 4, 5}};
  const Bounds box = bounds(mesh);
  EXPECT_EQ(box.size(), Vec3(2, 6, 2));
  EXPECT_EQ(box.middle(), Vec3(0, 1, 4));
}

TEST(Mesh, AreaVectorPointsOutOfACounterClockwiseTriangle) {
  const TriangleMesh mesh = tetrahedron();
  EXPECT_EQ(area_vector_doubled(mesh, mesh.triangles[0]), Vec3(0, 0, -1));
}

TEST(Mesh, SignedVolumeIsPositiveOutwardAndNegativeInward) {
  TriangleMesh mesh = tetrahedron();
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6.0, 1e-15);
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_NEAR(signed_volume(mesh), -1.0 / 6.0, 1e-15);
}

TEST(Mesh, SignedVolumeDoesNotDependOnWhereTheMeshLies) {
  TriangleMesh mesh = tetrahedron();
  transform(mesh, {Quat::Identity(), Vec3(1e6, -1e6, 1e6)});
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6.0, 1e-9);
}

TEST(Mesh, TransformTurnsThenMoves) {
  TriangleMesh mesh = tetrahedron();
  transform(mesh, {rotation_about(Vec3::UnitZ(), std::acos(-1.0) / 2.0), Vec3(10, 0, 0)});
  EXPECT_LT((mesh.vertices[1] - Vec3(10, 1, 0)).norm(), 1e-15);
}

TEST(Mesh, EdgeNeighboursOfATetrahedron) {
  const auto neighbours = edge_neighbours(tetrahedron());
  // Edge 0-2 of triangle 0 is shared with triangle 3, 2-1 with 2, 1-0 with 1.
  EXPECT_EQ(neighbours[0], (std::array<std::int32_t, 3>{3, 2, 1}));
}

TEST(Mesh, EdgeNeighboursAreMinusOneAtABoundary) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  EXPECT_EQ(boundary_edges(mesh), 3);
}

TEST(Mesh, EdgeNeighboursRefuseThreeTrianglesAtAnEdge) {
  TriangleMesh mesh = tetrahedron();
  mesh.vertices.emplace_back(1, 1, 1);
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_THAT([&] { (void)edge_neighbours(mesh); },
              ThrowsMessage<InputError>(HasSubstr("vertices 0 and 1 has 3 triangles")));
}

TEST(Mesh, EdgeNeighboursRefuseATriangleTurnedOver) {
  TriangleMesh mesh = tetrahedron();
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  EXPECT_THAT([&] { (void)edge_neighbours(mesh); }, ThrowsMessage<InputError>(HasSubstr("inverted")));
}

TEST(Mesh, EdgeNeighboursRefuseAnIndexOutOfRange) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles[1][2] = 4;
  EXPECT_THAT([&] { (void)edge_neighbours(mesh); },
              ThrowsMessage<InputError>(HasSubstr("triangle 1 names vertex 4")));
}

TEST(Mesh, EdgeNeighboursRefuseATriangleThatNamesAVertexTwice) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles[1][2] = mesh.triangles[1][1];
  EXPECT_THAT([&] { (void)edge_neighbours(mesh); }, ThrowsMessage<InputError>(HasSubstr("one vertex twice")));
}

TEST(Mesh, RefineLeavesNoLongEdgeAndKeepsTheSurface) {
  const TriangleMesh coarse = make_box({0.06, 0.06, 0.04}, 1.0);
  const TriangleMesh fine = refine(coarse, 0.0025);
  EXPECT_LE(longest_edge(fine), 0.0025);
  EXPECT_NEAR(area(fine), area(coarse), 1e-12);
  EXPECT_NEAR(signed_volume(fine), 0.06 * 0.06 * 0.04, 1e-15);
  EXPECT_EQ(boundary_edges(fine), 0);
  EXPECT_GT(worst_shape(fine), 0.6);
}

TEST(Mesh, RefineKeepsOriginalVerticesAtTheirIndex) {
  const TriangleMesh coarse = make_ball(0.02, 80);
  const TriangleMesh fine = refine(coarse, 0.003);
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) EXPECT_EQ(fine.vertices[v], coarse.vertices[v]);
}

TEST(Mesh, RefineLeavesAFineMeshAlone) {
  const TriangleMesh mesh = tetrahedron();
  const TriangleMesh same = refine(mesh, 2.0);
  EXPECT_EQ(same.vertices, mesh.vertices);
  EXPECT_EQ(same.triangles, mesh.triangles);
}

TEST(Mesh, RefineSplitsNeedlesAcrossTheirLength) {
  TriangleMesh needle;  // like the side of a long thin shaft
  needle.vertices = {{0, 0, 0}, {0.35, 0, 0}, {0.35, 0.0005, 0}};
  needle.triangles = {{0, 1, 2}};
  const TriangleMesh fine = refine(needle, 0.002);
  EXPECT_LE(longest_edge(fine), 0.002);
  EXPECT_LT(fine.triangles.size(), 2U * 256U);  // two per step of at most 0.35 m / 256
}

TEST(Mesh, RefineTakesOpenAndBranchingMeshes) {
  TriangleMesh fan = tetrahedron();
  fan.vertices.emplace_back(1, 1, 1);
  fan.triangles.push_back({0, 1, 4});
  const TriangleMesh fine = refine(fan, 0.1);
  EXPECT_LE(longest_edge(fine), 0.1);
  EXPECT_NEAR(area(fine), area(fan), 1e-12);
}

TEST(Mesh, RefineDoesNotDependOnChance) {
  const TriangleMesh ball = make_ball(0.02, 320);
  const TriangleMesh one = refine(ball, 0.001);
  const TriangleMesh two = refine(ball, 0.001);
  EXPECT_EQ(one.vertices, two.vertices);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(Mesh, RefineRefusesALimitThatIsNotPositive) {
  EXPECT_THROW((void)refine(tetrahedron(), 0.0), ParameterError);
  EXPECT_THROW((void)refine(tetrahedron(), std::nan("")), ParameterError);
}

TEST(Mesh, RefineGivesUpOnABoundlessMesh) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1e6, 0, 0}, {0, 1e6, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THAT([&] { (void)refine(mesh, 1e-3); }, ThrowsMessage<InputError>(HasSubstr("unit")));
}

TEST(Mesh, SubdivisionKeepsSurfaceAndClosedness) {
  const TriangleMesh coarse = make_ball(0.02, 80);
  const TriangleMesh fine = subdivide(coarse);
  EXPECT_EQ(fine.triangles.size(), 320U);
  EXPECT_EQ(fine.vertices.size(), 162U);  // V - E + F = 2
  EXPECT_EQ(boundary_edges(fine), 0);
  EXPECT_NEAR(area(fine), area(coarse), 1e-15);
  EXPECT_NEAR(signed_volume(fine), signed_volume(coarse), 1e-18);
}

TEST(Primitives, BallHasTheTrianglesAskedForAllVerticesOnTheSphere) {
  for (const auto& [asked, got] : {std::pair{1, 20U}, {80, 80U}, {81, 320U}, {1280, 1280U}}) {
    const TriangleMesh ball = make_ball(0.003, asked);
    EXPECT_EQ(ball.triangles.size(), got);
    EXPECT_EQ(ball.vertices.size(), got / 2 + 2);
    for (const Vec3& vertex : ball.vertices) EXPECT_NEAR(vertex.norm(), 0.003, 1e-18);
    EXPECT_EQ(boundary_edges(ball), 0);
    EXPECT_GT(signed_volume(ball), 0.0);
  }
}

TEST(Primitives, BallVolumeTendsToThatOfTheSphere) {
  EXPECT_NEAR(signed_volume(make_ball(1.0, 20480)), 4.0 / 3.0 * std::acos(-1.0), 4e-3);
}

TEST(Primitives, BallRefusesBadRadiusAndTooManyTriangles) {
  EXPECT_THROW((void)make_ball(0.0), ParameterError);
  EXPECT_THROW((void)make_ball(std::nan("")), ParameterError);
  EXPECT_THROW((void)make_ball(1.0, 2'000'000'000), ParameterError);
}

TEST(Primitives, BoxIsClosedAndOfItsSize) {
  const TriangleMesh box = make_box({0.06, 0.06, 0.04}, 0.02);
  // 3 x 3 squares on two sides, 3 x 2 on four.
  EXPECT_EQ(box.triangles.size(), 2U * (2 * 9 + 4 * 6));
  EXPECT_EQ(boundary_edges(box), 0);
  EXPECT_NEAR(signed_volume(box), 0.06 * 0.06 * 0.04, 1e-18);
  EXPECT_EQ(bounds(box).high, Vec3(0.03, 0.03, 0.02));
  EXPECT_EQ(bounds(box).low, Vec3(-0.03, -0.03, -0.02));
}

TEST(Primitives, BoxRefusesBadSizes) {
  EXPECT_THROW((void)make_box({0.0, 1.0, 1.0}, 1.0), ParameterError);
  EXPECT_THROW((void)make_box({1.0, std::nan(""), 1.0}, 1.0), ParameterError);
  EXPECT_THROW((void)make_box({1.0, 1.0, 1.0}, 0.0), ParameterError);
  EXPECT_THROW((void)make_box({1.0, 1.0, 1.0}, 1e-9), ParameterError);
}

TEST(Tool, AJawTurnsAboutItsPivotByTheGripper) {
  ToolPart jaw;
  jaw.is_jaw = true;
  jaw.pivot = {0, 0, 1};
  jaw.axis = Vec3::UnitY();
  jaw.open_angle = std::acos(-1.0);
  EXPECT_LT((part_pose(jaw, 0.0) * Vec3(0, 0, 2) - Vec3(0, 0, 2)).norm(), 1e-15);
  EXPECT_LT((part_pose(jaw, 0.5) * Vec3(0, 0, 2) - Vec3(1, 0, 1)).norm(), 1e-15);
  EXPECT_LT((part_pose(jaw, 1.0) * Vec3(0, 5, 2) - Vec3(0, 5, 0)).norm(), 1e-15);
}

TEST(Tool, AShaftStays) {
  ToolPart shaft;
  shaft.open_angle = 1.0;
  EXPECT_EQ(part_pose(shaft, 1.0) * Vec3(1, 2, 3), Vec3(1, 2, 3));
}

}  // namespace
}  // namespace palpate::geometry
