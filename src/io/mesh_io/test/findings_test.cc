// Tests of the defects that read_mesh() finds, and of the requirements on an organ.
#include <cstdint>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

LoadedMesh with_findings(geometry::TriangleMesh mesh) {
  LoadedMesh loaded{std::move(mesh), {}};
  loaded.findings = findings_of(loaded.mesh);
  return loaded;
}

geometry::TriangleMesh two_boxes(const Vec3& offset, bool second_is_turned) {
  geometry::TriangleMesh mesh = geometry::make_box({0.06, 0.06, 0.06}, 0.06);
  const geometry::TriangleMesh other = geometry::make_box({0.02, 0.02, 0.02}, 0.02);
  for (const Vec3& vertex : other.vertices) mesh.vertices.emplace_back(vertex + offset);
  for (auto [a, b, c] : other.triangles) {
    if (second_is_turned) std::swap(b, c);
    mesh.triangles.push_back({a + 8, b + 8, c + 8});
  }
  return mesh;
}

TEST(Findings, OfABallAreClean) {
  const MeshFindings findings = findings_of(geometry::make_ball(0.02, 320));
  EXPECT_TRUE(findings.closed);
  EXPECT_TRUE(findings.manifold);
  EXPECT_EQ(findings.shells, 1);
  EXPECT_THAT(findings.defects, IsEmpty());
}

TEST(Findings, OfNothing) {
  const MeshFindings findings = findings_of({});
  EXPECT_FALSE(findings.closed);
  EXPECT_FALSE(findings.manifold);
  EXPECT_EQ(findings.shells, 0);
}

TEST(Findings, ABoundary) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 320);
  mesh.triangles.pop_back();
  const MeshFindings findings = findings_of(mesh);
  EXPECT_FALSE(findings.closed);
  EXPECT_TRUE(findings.manifold);
  EXPECT_THAT(findings.defects, ElementsAre("3 boundary edges"));
}

TEST(Findings, ATriangleTurnedOver) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 320);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  EXPECT_THAT(findings_of(mesh).defects, ElementsAre("3 edges whose two triangles differ in orientation"));
}

TEST(Findings, ASurfaceOrientedInwards) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 320);
  for (geometry::Triangle& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(findings_of(mesh).defects, ElementsAre("1 shell oriented inwards"));
}

TEST(Findings, TwoBallsThatShareAVertex) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 20);
  geometry::TriangleMesh other = mesh;
  for (const Vec3& vertex : other.vertices) mesh.vertices.emplace_back(2.0 * other.vertices[0] - vertex);
  for (const auto& [a, b, c] : other.triangles) {
    const auto moved = [](std::int32_t v) { return v == 0 ? 0 : v + 12; };
    mesh.triangles.push_back({moved(a), moved(c), moved(b)});  // a point reflection reverses triangles
  }
  const MeshFindings findings = findings_of(mesh);
  EXPECT_TRUE(findings.closed);
  EXPECT_FALSE(findings.manifold);
  EXPECT_EQ(findings.shells, 2);
  EXPECT_THAT(findings.defects, ElementsAre("1 vertex where separate surfaces touch"));
}

TEST(Findings, AnEdgeOfFourTriangles) {
  // Two tetrahedra with the edge 0-1 in common.
  geometry::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 4, 1}, {0, 1, 5}, {1, 4, 5}, {0, 5, 4}};
  const MeshFindings findings = findings_of(mesh);
  EXPECT_FALSE(findings.manifold);
  EXPECT_THAT(findings.defects, ElementsAre("1 edge of more than two triangles"));
}

TEST(Findings, TrianglesWithoutArea) {
  geometry::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-8, 0}, {0.5, 1e-6, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 1}};
  EXPECT_THAT(findings_of(mesh).remarks, Contains("2 triangles without area"));
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THAT(findings_of(mesh).remarks, IsEmpty());
}

TEST(Findings, ACavityIsNoDefectButAShellWithinAShellIs) {
  EXPECT_THAT(findings_of(two_boxes(Vec3::Zero(), true)).defects, IsEmpty());
  EXPECT_NEAR(findings_of(two_boxes(Vec3::Zero(), true)).volume, 216e-6 - 8e-6, 1e-12);
  EXPECT_THAT(findings_of(two_boxes(Vec3::Zero(), false)).defects,
              ElementsAre("1 shell inside another and not a cavity"));
}

TEST(Findings, SeparateShellsMustEachBeOrientedOutwards) {
  EXPECT_THAT(findings_of(two_boxes({0.1, 0, 0}, false)).defects, IsEmpty());
  EXPECT_EQ(findings_of(two_boxes({0.1, 0, 0}, false)).shells, 2);
  EXPECT_THAT(findings_of(two_boxes({0.1, 0, 0}, true)).defects, ElementsAre("1 shell oriented inwards"));
}

TEST(RequireOrgan, TakesASoundMesh) {
  EXPECT_NO_THROW(require_organ(with_findings(geometry::make_ball(0.02, 320)), "ball"));
}

TEST(RequireOrgan, RefusesAnOpenMeshAndReportsWhatIsWrong) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 320);
  mesh.triangles.pop_back();
  EXPECT_THAT([&] { require_organ(with_findings(mesh), "x.stl"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("x.stl: "), HasSubstr("3 boundary edges"), HasSubstr("repair"))));
}

TEST(RequireOrgan, RefusesASizeThatSpeaksForAnotherUnit) {
  EXPECT_THAT([] { require_organ(with_findings(geometry::make_ball(40.0, 80)), "x.stl"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("5 to 2000 mm"), HasSubstr("1000 times smaller"))));
  EXPECT_THAT([] { require_organ(with_findings(geometry::make_ball(4e-5, 80)), "x.stl"); },
              ThrowsMessage<InputError>(HasSubstr("1000 times larger")));
}

TEST(RequireOrgan, TakesSizesUpToItsBounds) {
  EXPECT_NO_THROW(require_organ(with_findings(geometry::make_box({0.005, 0.001, 0.001}, 1.0)), "x"));
  EXPECT_NO_THROW(require_organ(with_findings(geometry::make_box({2.0, 0.1, 0.1}, 1.0)), "x"));
  EXPECT_THROW(require_organ(with_findings(geometry::make_box({0.00499, 0.001, 0.001}, 1.0)), "x"),
               InputError);
  EXPECT_THROW(require_organ(with_findings(geometry::make_box({2.01, 0.1, 0.1}, 1.0)), "x"), InputError);
}

TEST(RequireTool, RefusesAMeshWithoutExtentOrOfAbsurdSize) {
  const auto cube = [](double side) { return with_findings(geometry::make_box({side, side, side}, side)); };
  EXPECT_NO_THROW(require_tool(cube(1.001e-4), "x"));
  EXPECT_NO_THROW(require_tool(cube(4.999), "x"));
  for (const double bad : {1e-38, 0.99e-4, 5.01, 1e32}) {
    EXPECT_THAT([&] { require_tool(cube(bad), "x.gltf"); },
                ThrowsMessage<InputError>(HasSubstr("x.gltf: its largest side is")));
  }
}

}  // namespace
}  // namespace palpate::mesh_io
