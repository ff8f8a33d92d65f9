#include "io/mesh_io/repair/repair.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/signed_distance.h"
#include "io/mesh_io/repair/crossings.h"
#include "io/shapes/test/shape_checks.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::mesh_io {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

void turn(geometry::Triangle& triangle) { std::swap(triangle[0], triangle[1]); }

void turn_all(geometry::TriangleMesh& mesh) {
  std::for_each(mesh.triangles.begin(), mesh.triangles.end(), turn);
}

/// Adds `other`, scaled about its origin and translated.
void add(geometry::TriangleMesh& mesh, const geometry::TriangleMesh& other, const Vec3& offset,
         double scale = 1.0) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& v : other.vertices) mesh.vertices.emplace_back(scale * v + offset);
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

geometry::TriangleMesh ball() { return geometry::make_ball(0.02, 320); }

geometry::TriangleMesh box() { return geometry::make_box({0.04, 0.04, 0.04}, 0.01); }

void expect_sound(const geometry::TriangleMesh& mesh) {
  EXPECT_TRUE(
      geometry::test::is_closed(mesh));  // throws unless each edge has two half-edges of opposite directions
  EXPECT_THAT(findings_of(mesh).defects, IsEmpty());
  EXPECT_GT(geometry::signed_volume(mesh), 0.0);
  EXPECT_NO_THROW(geometry::SignedDistance{mesh});
}

void expect_same(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.vertices, b.vertices);
}

/// Repairs, expects a valid surface of the given volume, and that a second repair changes nothing.
RepairedSurface repaired(const geometry::TriangleMesh& mesh, double volume, double share = 1e-9) {
  RepairedSurface first = repair_surface(mesh);
  EXPECT_EQ(first.refusal, "");
  if (!first.refusal.empty()) return first;
  expect_sound(first.mesh);
  EXPECT_NEAR(geometry::signed_volume(first.mesh), volume, share * volume);
  const RepairedSurface second = repair_surface(first.mesh);
  EXPECT_THAT(second.repairs, IsEmpty());
  EXPECT_EQ(second.refusal, "");
  expect_same(second.mesh, first.mesh);
  return first;
}

class BuiltinRepair : public ::testing::TestWithParam<std::string> {};

TEST_P(BuiltinRepair, LeavesTheOrganAlone) {
  const geometry::TriangleMesh organ = geometry::make_organ(GetParam());
  const RepairedSurface result = repair_surface(organ);
  EXPECT_EQ(result.refusal, "");
  EXPECT_THAT(result.repairs, IsEmpty());
  expect_same(result.mesh, organ);
}

INSTANTIATE_TEST_SUITE_P(Each, BuiltinRepair, ::testing::ValuesIn(geometry::builtin_organ_names()),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
                           return name;
                         });

TEST(Repair, OrientsASurfaceThatIsOrientedInwards) {
  geometry::TriangleMesh mesh = ball();
  turn_all(mesh);
  EXPECT_THAT(repaired(mesh, geometry::signed_volume(ball())).repairs,
              ElementsAre("turned all 320 triangles outwards"));
}

TEST(Repair, OrientsTheTrianglesThatAreOrientedAgainstTheRest) {
  geometry::TriangleMesh mesh = ball();
  for (const std::size_t t : {3U, 77U, 78U, 200U}) turn(mesh.triangles[t]);
  const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()));
  EXPECT_THAT(result.repairs, ElementsAre("turned 4 triangles outwards"));
  expect_same(result.mesh, [] {
    geometry::TriangleMesh want = ball();
    for (const std::size_t t : {3U, 77U, 78U, 200U})  // the same triangle from another corner
      std::rotate(want.triangles[t].begin(), want.triangles[t].begin() + 1, want.triangles[t].end());
    return want;
  }());
}

TEST(Repair, DropsDuplicateTrianglesEitherWayRound) {
  geometry::TriangleMesh mesh = ball();
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.push_back(mesh.triangles[6]);
  turn(mesh.triangles.back());
  EXPECT_THAT(repaired(mesh, geometry::signed_volume(ball())).repairs,
              ElementsAre("dropped 2 duplicate triangles"));
}

TEST(Repair, DropsTrianglesThatNameAVertexTwice) {
  geometry::TriangleMesh mesh = ball();
  mesh.triangles.push_back({4, 4, 9});
  EXPECT_THAT(repaired(mesh, geometry::signed_volume(ball())).repairs,
              ElementsAre("dropped 1 triangle that names a vertex twice"));
}

TEST(Repair, DropsDanglingFaces) {
  geometry::TriangleMesh mesh = ball();
  const auto [a, b, c] = mesh.triangles[10];
  const Vec3 outside = 1.1 * mesh.vertices[static_cast<std::size_t>(a)];
  mesh.vertices.emplace_back(outside);
  mesh.vertices.emplace_back(outside + Vec3(0.001, 0.002, 0.003));
  const auto out = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
  mesh.triangles.push_back({a, b, out});
  mesh.triangles.push_back({b, out, out - 1});
  EXPECT_THAT(repaired(mesh, geometry::signed_volume(ball())).repairs,
              ElementsAre("dropped 1 patch of dangling faces (2 triangles)"));
}

/// A box and its mirror image at its right side; each has that side, so the two coincide.
geometry::TriangleMesh two_boxes_with_a_side_in_common() {
  const geometry::TriangleMesh one = geometry::make_box({0.02, 0.02, 0.02}, 1.0);
  geometry::TriangleMesh mesh = one;
  std::vector<std::int32_t> image;
  for (const Vec3& v : one.vertices) {
    const Vec3 mirrored(0.02 - v.x(), v.y(), v.z());
    const auto same = std::find_if(mesh.vertices.begin(), mesh.vertices.end(),
                                   [&](const Vec3& p) { return (p - mirrored).norm() < 1e-9; });
    image.push_back(static_cast<std::int32_t>(same - mesh.vertices.begin()));
    if (same == mesh.vertices.end()) mesh.vertices.push_back(mirrored);
  }
  for (const auto& [a, b, c] : one.triangles) {
    const auto at = [&](std::int32_t v) { return image[static_cast<std::size_t>(v)]; };
    mesh.triangles.push_back({at(a), at(c), at(b)});
  }
  return mesh;
}

TEST(Repair, DropsTheFacesBetweenTwoSolidsThatShareASide) {
  const RepairedSurface result = repaired(two_boxes_with_a_side_in_common(), 16e-6);
  EXPECT_THAT(result.repairs, ElementsAre("dropped 2 duplicate triangles",
                                          "dropped 1 patch of internal faces (2 triangles)"));
}

TEST(Repair, RefusesEdgesOfThreeTrianglesWhoseFacesNeitherDangleNorLieInside) {
  geometry::TriangleMesh mesh = two_boxes_with_a_side_in_common();
  const auto is_in_wall = [&](const geometry::Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) {
      return std::abs(mesh.vertices[static_cast<std::size_t>(v)].x() - 0.01) < 1e-9;
    });
  };
  const auto end = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.triangles.size() / 2);
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), end, is_in_wall), end);  // one side
  EXPECT_THAT(repair_surface(mesh).refusal, HasSubstr("4 edges of more than two triangles (the first at ("));
}

TEST(Repair, PartsSolidsThatTouchInAVertex) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 20);
  const geometry::TriangleMesh other = mesh;
  for (const Vec3& vertex : other.vertices) mesh.vertices.emplace_back(2.0 * other.vertices[0] - vertex);
  for (const auto& [a, b, c] : other.triangles) {
    const auto moved = [](std::int32_t v) { return v == 0 ? 0 : v + 12; };
    mesh.triangles.push_back({moved(a), moved(c), moved(b)});
  }
  const RepairedSurface result = repaired(mesh, 2.0 * geometry::signed_volume(other));
  EXPECT_THAT(result.repairs, ElementsAre("separated touching surfaces with 1 new vertex"));
  EXPECT_THAT(result.remarks, ElementsAre("2 separate components"));
}

TEST(Repair, PartsSolidsThatTouchInAnEdgeWithAnyOrientation) {
  geometry::TriangleMesh mesh;  // two tetrahedra with the common edge 0-1, volume 1/6 cm^3 each
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  for (Vec3& v : mesh.vertices) v *= 0.01;
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 4, 1}, {0, 1, 5}, {1, 4, 5}, {0, 5, 4}};
  for (int turned = 0; turned < 256; ++turned) {
    geometry::TriangleMesh damaged = mesh;
    for (std::size_t t = 0; t < 8; ++t) {
      if ((turned >> t & 1) != 0) turn(damaged.triangles[t]);
    }
    const RepairedSurface result = repair_surface(damaged);
    ASSERT_EQ(result.refusal, "") << turned;
    ASSERT_TRUE(geometry::test::is_closed(result.mesh)) << turned;
    ASSERT_THAT(findings_of(result.mesh).defects, IsEmpty()) << turned;
  }
  EXPECT_THAT(repaired(mesh, 1e-6 / 3.0).remarks, ElementsAre("2 separate components"));
}

TEST(Repair, ClosesAMissingTriangleAsItWas) {
  geometry::TriangleMesh mesh = ball();
  mesh.triangles.erase(mesh.triangles.begin() + 40);
  const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()));
  EXPECT_THAT(result.repairs, ElementsAre(StartsWith("closed 1 hole with 1 triangle (")));
}

TEST(Repair, ClosesAHoleInAFlatSideWithoutChangingTheVolume) {
  // 4 x 2 squares in the middle of a side are missing; the smallest patch is flat.
  const geometry::TriangleMesh whole = geometry::make_box({0.04, 0.04, 0.04}, 0.0025);
  geometry::TriangleMesh mesh = whole;
  std::erase_if(mesh.triangles, [&](const geometry::Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) {
      const Vec3 p = mesh.vertices[static_cast<std::size_t>(v)];
      return p.z() > 0.0199 && std::abs(p.x()) < 0.0051 && std::abs(p.y()) < 0.0026;
    });
  });
  ASSERT_EQ(mesh.triangles.size() + 16, whole.triangles.size());
  (void)repaired(mesh, geometry::signed_volume(whole));
}

TEST(Repair, RefusesALargeHoleAndReportsHowLargeAndWhere) {
  geometry::TriangleMesh mesh = ball();
  std::erase_if(mesh.triangles, [&](const geometry::Triangle& t) {
    return mesh.vertices[static_cast<std::size_t>(t[0])].z() > 0.005;
  });
  const RepairedSurface result = repair_surface(mesh);
  EXPECT_THAT(result.refusal,
              AllOf(StartsWith("a hole of "), HasSubstr(" edges, "), HasSubstr(" mm across")));
}

TEST(Repair, ClosesAHoleUpToAFifthOfTheDiagonalAndNoLarger) {
  // A ball of radius 20 mm has the diagonal 69.3 mm: 13.9 mm is the limit.
  const geometry::TriangleMesh fine = geometry::make_ball(0.02, 20480);
  const auto open_at = [&](double height) {
    geometry::TriangleMesh mesh = fine;
    std::erase_if(mesh.triangles, [&](const geometry::Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](std::int32_t v) {
        return mesh.vertices[static_cast<std::size_t>(v)].z() > height;
      });
    });
    return repair_surface(mesh);
  };
  EXPECT_EQ(open_at(0.0196).refusal, "");                          // radius of the hole 4 mm, box 11 mm
  EXPECT_THAT(open_at(0.0180).refusal, StartsWith("a hole of "));  // 8.7 mm, 24 mm
}

TEST(Repair, JoinsBoundariesThatDifferByTheRoundingOfText) {
  geometry::TriangleMesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> rounding(-1e-9, 1e-9);
  for (const geometry::Triangle& t : ball().triangles) {  // each with its own three vertices, slightly moved
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const std::int32_t v : t) {
      mesh.vertices.emplace_back(ball().vertices[static_cast<std::size_t>(v)] +
                                 Vec3(rounding(random), rounding(random), rounding(random)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()), 1e-6);
  EXPECT_EQ(result.mesh.vertices.size(), ball().vertices.size());
  EXPECT_THAT(result.repairs, ElementsAre(StartsWith("joined 798 vertices at boundaries")));
}

TEST(Repair, JudgesAnOpenPatchAlikeHoweverFarOutItLies) {
  const auto patch_at = [](double x) {
    geometry::TriangleMesh mesh;
    mesh.vertices = {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}, {x, 1, 1e-9}, {x, 1, 1}, {x, 1e-9, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    return repair_surface(mesh);
  };
  for (const double x : {0.0, 1e10, -6e37, 3.4e38}) {
    const RepairedSurface result = patch_at(x);
    EXPECT_THAT(result.repairs, ElementsAre(StartsWith("joined 2 vertices at boundaries"))) << x;
    EXPECT_THAT(result.refusal, StartsWith("a hole of 4 edges, 1410 mm across")) << x;
  }
}

TEST(Repair, TakesOutTrianglesWithoutAreaAndStaysClosed) {
  // A vertex in the middle of an edge, used on one side only, by a triangle without area.
  geometry::TriangleMesh mesh = ball();
  const auto [a, b, c] = mesh.triangles[0];
  const auto middle = static_cast<std::int32_t>(mesh.vertices.size());
  const Vec3 point =
      0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]);
  mesh.vertices.push_back(point);
  mesh.triangles[0] = {a, middle, c};
  mesh.triangles.push_back({middle, b, c});
  mesh.triangles.push_back({a, b, middle});
  const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()));
  EXPECT_THAT(result.repairs, ElementsAre("removed 1 triangle without area"));
  EXPECT_EQ(result.mesh.triangles.size(), 322U);
}

TEST(Repair, ShrinksAnEdgeWithoutLength) {
  // The vertex exists twice, 1e-10 m apart, with two slivers between.
  geometry::TriangleMesh mesh = ball();
  const std::int32_t v = mesh.triangles[0][0];
  const auto twin = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(mesh.vertices[static_cast<std::size_t>(v)] + Vec3(1e-10, 0, 0));
  std::vector<std::size_t> around;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::count(mesh.triangles[t].begin(), mesh.triangles[t].end(), v) > 0) around.push_back(t);
  }
  const auto neighbours = geometry::edge_neighbours(mesh);
  // Gives the second vertex to the first triangle; slivers close the two seams.
  geometry::Triangle& moved = mesh.triangles[around[0]];
  while (moved[0] != v) std::rotate(moved.begin(), moved.begin() + 1, moved.end());
  const auto [from, p, q] = moved;
  moved[0] = twin;
  mesh.triangles.push_back({v, p, twin});
  mesh.triangles.push_back({v, twin, q});
  ASSERT_TRUE(geometry::test::is_closed(mesh));
  const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()), 1e-6);
  EXPECT_THAT(result.repairs, ElementsAre("removed 2 triangles without area"));
  EXPECT_EQ(result.mesh.vertices.size(), ball().vertices.size());
}

TEST(Repair, DropsInnerShellsWithAnyOrientation) {
  for (const bool is_turned : {false, true}) {
    geometry::TriangleMesh inner = ball();
    if (is_turned) turn_all(inner);
    geometry::TriangleMesh mesh = ball();
    add(mesh, inner, {0.001, 0.0, 0.0}, 0.6);
    const RepairedSurface result = repaired(mesh, geometry::signed_volume(ball()));
    EXPECT_THAT(result.repairs,
                ::testing::Contains("dropped 1 inner shell (320 triangles): an organ is solid"));
    EXPECT_EQ(result.mesh.triangles.size(), 320U);
  }
}

TEST(Repair, DropsSmallComponentsAndKeepsLargeOnesAndReportsIt) {
  geometry::TriangleMesh mesh = ball();
  add(mesh, ball(), {0.05, 0.0, 0.0}, 0.1);
  add(mesh, ball(), {-0.05, 0.0, 0.0}, 0.5);
  const RepairedSurface result = repaired(mesh, 1.125 * geometry::signed_volume(ball()));
  EXPECT_THAT(result.repairs, ElementsAre("dropped 1 small component (320 triangles, 0.09 % of the volume)"));
  EXPECT_THAT(result.remarks, ElementsAre("2 separate components"));
}

TEST(Repair, DropsSmallOpenComponents) {
  geometry::TriangleMesh mesh = ball();
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const double x : {0.0, 0.001, 0.002}) mesh.vertices.emplace_back(0.03, x, x * x);
  mesh.triangles.push_back({first, first + 1, first + 2});
  EXPECT_THAT(repaired(mesh, geometry::signed_volume(ball())).repairs,
              ElementsAre("dropped 1 small open component (1 triangle)"));
}

TEST(Repair, RefusesComponentsThatGoThroughEachOther) {
  geometry::TriangleMesh mesh = ball();
  add(mesh, ball(), {0.02, 0.001, 0.0005});
  EXPECT_THAT(repair_surface(mesh).refusal, HasSubstr("components go through each other"));
}

TEST(Repair, RefusesManyComponentsOfLikeSize) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.001, 20);
  for (int n = 1; n < 40; ++n) add(mesh, geometry::make_ball(0.001, 20), {0.003 * n, 0.0, 0.0});
  EXPECT_THAT(repair_surface(mesh).refusal, HasSubstr("40 separate components"));
}

TEST(Repair, RefusesManySoundComponentsWithARemedyThatFitsThem) {
  LoadedMesh loaded{geometry::make_ball(0.001, 20), {}};
  for (int n = 1; n < 33; ++n) add(loaded.mesh, geometry::make_ball(0.001, 20), {0.003 * n, 0.0, 0.0});
  EXPECT_THAT(
      [&] { (void)repair_organ(loaded, "aorta.stl"); },
      testing::ThrowsMessage<InputError>(
          "aorta.stl: cannot be an organ: it is 33 separate components of like size, at most 32 can be "
          "one organ: join parts in a mesh tool, or leave some out"));
}

/// A ball with one vertex moved through the inside and out again, 10 mm away.
geometry::TriangleMesh ball_with_crossings() {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, 5120);
  Vec3& drawn = mesh.vertices[static_cast<std::size_t>(mesh.triangles[0][0])];
  const Vec3 aside = drawn.cross(Vec3(0.3, 0.5, 0.81)).normalized();
  drawn = 0.0204 * (drawn + 0.01 * aside).normalized();
  return mesh;
}

TEST(Repair, KeepsAFewCrossingTrianglesAndReportsIt) {
  const geometry::TriangleMesh mesh = ball_with_crossings();
  const RepairedSurface result = repair_surface(mesh);
  EXPECT_EQ(result.refusal, "");
  EXPECT_GT(geometry::test::crossings(mesh, mesh), 0);
  EXPECT_THAT(result.remarks, ElementsAre(HasSubstr("of triangles that go through each other (")));
}

/// A ball of 20 mm whose part beyond x = 5 mm is mirrored at the plane z = 0, so that its upper and its lower
/// side change places there. The mesh is symmetric about that plane, so edges meet edges, never the inside of
/// a triangle.
geometry::TriangleMesh half_mirrored_ball(int triangles) {
  geometry::TriangleMesh mesh = geometry::make_ball(0.02, triangles);
  for (Vec3& v : mesh.vertices) v.z() *= v.x() > 0.005 ? -1.0 : 1.0;
  return mesh;
}

TEST(Repair, RefusesASurfaceThatGoesThroughItselfEdgeOnEdge) {
  EXPECT_THAT(repair_surface(half_mirrored_ball(320)).refusal,
              HasSubstr("of its triangles go through each other"));
}

TEST(Repair, RefusesASurfaceOfWhichAPartIsInsideOutBeyondAFewCrossings) {
  geometry::TriangleMesh twisted = geometry::make_ball(0.02, 20480);  // two lobes with a thin neck at x = 0
  for (Vec3& v : twisted.vertices) {
    const double width = 0.05 + 0.95 * std::min(1.0, std::abs(v.x()) / 0.01);
    v.y() *= width;
    v.z() *= v.x() > 0.0 ? -width : width;
  }
  EXPECT_THAT(repair_surface(twisted).refusal,
              AllOf(StartsWith("it goes through itself (at "), HasSubstr("of its surface, around ("),
                    HasSubstr("is inside out")));
}

TEST(Repair, RefusesASurfaceWithOneSide) {
  geometry::TriangleMesh mesh;  // a Moebius strip of 24 pieces
  constexpr int kPieces = 24;
  for (int n = 0; n < kPieces; ++n) {
    const double turn_at = 2.0 * 3.14159265358979 * n / kPieces;
    const Vec3 across(std::cos(turn_at / 2) * std::cos(turn_at), std::cos(turn_at / 2) * std::sin(turn_at),
                      std::sin(turn_at / 2));
    const Vec3 middle(0.02 * std::cos(turn_at), 0.02 * std::sin(turn_at), 0.0);
    mesh.vertices.emplace_back(middle - 0.005 * across);
    mesh.vertices.emplace_back(middle + 0.005 * across);
  }
  for (std::int32_t n = 0; n < kPieces; ++n) {
    const bool is_last = n + 1 == kPieces;
    const std::int32_t next = is_last ? 1 : 2 * n + 2;
    const std::int32_t after = is_last ? 0 : 2 * n + 3;
    mesh.triangles.push_back({2 * n, next, 2 * n + 1});
    mesh.triangles.push_back({next, after, 2 * n + 1});
  }
  EXPECT_THAT(repair_surface(mesh).refusal, HasSubstr("only one side"));
}

TEST(Repair, RefusesWhatEnclosesNothing) {
  geometry::TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_NE(repair_surface(flat).refusal, "");
  EXPECT_NE(repair_surface({}).refusal, "");
}

TEST(FindCrossings, FindsThePairsThatATestOfEachPairFinds) {
  geometry::TriangleMesh mesh = ball();
  std::mt19937 random(3);
  for (Vec3& v : mesh.vertices) {
    for (double& x : v) x += 8e-3 * (static_cast<double>(random()) / 0x1p31 - 1.0);
  }
  std::vector<std::array<std::uint32_t, 2>> expected;
  for (std::uint32_t s = 0; s < mesh.triangles.size(); ++s) {
    for (std::uint32_t t = s + 1; t < mesh.triangles.size(); ++t) {
      if (!find_crossings({mesh.vertices, {mesh.triangles[s], mesh.triangles[t]}}).pairs.empty())
        expected.push_back({s, t});
    }
  }
  EXPECT_GT(expected.size(), 100U);
  EXPECT_EQ(find_crossings(mesh).pairs, expected);
}

TEST(RepairOrgan, FindsTheSameInASoundMeshWithAndWithoutItsFindings) {
  const geometry::TriangleMesh mesh = ball_with_crossings();
  const LoadedMesh unknown = repair_organ({mesh, {}}, "x.stl");
  const LoadedMesh known = repair_organ({mesh, findings_of(mesh)}, "x.stl");
  expect_same(known.mesh, mesh);
  expect_same(unknown.mesh, mesh);
  EXPECT_GT(unknown.findings.crossing_pairs, 0U);
  EXPECT_EQ(known.findings.crossing_pairs, unknown.findings.crossing_pairs);
  EXPECT_EQ(known.findings.remarks, unknown.findings.remarks);
  EXPECT_EQ(known.findings.repairs, unknown.findings.repairs);
  EXPECT_TRUE(known.findings.closed && known.findings.shells == 1);
}

TEST(RepairOrgan, AddsToTheFindingsAndNamesTheFileWhenItRefuses) {
  LoadedMesh loaded{ball(), {}};
  loaded.findings.repairs = {"cut 1 polygons into triangles"};
  turn_all(loaded.mesh);
  const LoadedMesh organ = repair_organ(loaded, "x.stl");
  EXPECT_THAT(organ.findings.repairs,
              ElementsAre("cut 1 polygons into triangles", "turned all 320 triangles outwards"));
  EXPECT_TRUE(organ.findings.closed);
  loaded.mesh.triangles.resize(200);
  EXPECT_THAT([&] { (void)repair_organ(loaded, "x.stl"); },
              ThrowsMessage<InputError>(AllOf(StartsWith("x.stl: cannot be an organ: "), HasSubstr("hole"))));
  EXPECT_THAT(
      [&] {
        (void)repair_organ({geometry::make_ball(40.0, 80), {}}, "x.stl");
      },
      ThrowsMessage<InputError>(HasSubstr("5 to 2000 mm")));
}

/// Random damage of a mesh.
class Damage final {
 public:
  Damage(const geometry::TriangleMesh& mesh, unsigned seed) : mesh_(mesh), random_(seed) {}

  geometry::TriangleMesh run() {
    const std::size_t whole = mesh_.triangles.size();
    turn_some(whole);
    if (chance()) repeat_some(whole);
    if (chance()) add_fins(whole);
    if (chance()) add_inner_shell();
    if (chance()) add_scrap();
    if (chance()) mesh_.triangles.push_back({1, 1, 2});
    if (chance()) remove_apart(whole);
    if (chance()) turn_all(mesh_);
    std::shuffle(mesh_.triangles.begin(), mesh_.triangles.end(), random_);
    for (geometry::Triangle& t : mesh_.triangles) std::rotate(t.begin(), t.begin() + below(3), t.end());
    return mesh_;
  }

 private:
  bool chance() { return below(2) == 0; }
  std::ptrdiff_t below(std::size_t n) { return static_cast<std::ptrdiff_t>(random_() % n); }
  std::size_t any(std::size_t n) { return random_() % n; }

  void turn_some(std::size_t whole) {
    for (std::size_t n = 0; n < whole / 3; ++n) turn(mesh_.triangles[any(whole)]);
  }
  void repeat_some(std::size_t whole) {
    for (int n = 0; n < 7; ++n) {
      const geometry::Triangle twin = mesh_.triangles[any(whole)];
      mesh_.triangles.push_back(twin);
      if (chance()) turn(mesh_.triangles.back());
    }
  }
  void add_fins(std::size_t whole) {
    const double size = geometry::bounds(mesh_).size().norm();
    for (int n = 0; n < 3; ++n) {
      const geometry::Triangle at = mesh_.triangles[any(whole)];
      const Vec3 p = mesh_.vertices[static_cast<std::size_t>(at[0])];
      mesh_.vertices.emplace_back(p + 0.01 * size * Vec3(1.0, 0.3, 0.5));
      mesh_.triangles.push_back({at[0], at[1], static_cast<std::int32_t>(mesh_.vertices.size()) - 1});
    }
  }
  void add_inner_shell() {
    geometry::TriangleMesh inner = mesh_;
    inner.triangles = original().triangles;
    if (chance()) turn_all(inner);
    add(mesh_, inner, Vec3::Zero(), 0.3);
  }
  void add_scrap() {
    add(mesh_, geometry::make_ball(0.02 * geometry::bounds(mesh_).size().minCoeff(), 20),
        geometry::bounds(mesh_).high * 3.0);
  }

  /// Removes triangles that share no vertex with each other or with a dangling face.
  void remove_apart(std::size_t whole) {
    std::vector<int> uses(mesh_.vertices.size(), 0);
    for (std::size_t t = whole; t < mesh_.triangles.size(); ++t) {
      for (const std::int32_t v : mesh_.triangles[t]) uses[static_cast<std::size_t>(v)] = 1;
    }
    std::vector<std::size_t> going;
    for (int n = 0; n < 5; ++n) {
      const std::size_t t = any(whole);
      const geometry::Triangle& triangle = mesh_.triangles[t];
      if (std::any_of(triangle.begin(), triangle.end(),
                      [&](std::int32_t v) { return uses[static_cast<std::size_t>(v)] != 0; }))
        continue;
      for (const std::int32_t v : triangle) uses[static_cast<std::size_t>(v)] = 1;
      going.push_back(t);
    }
    std::sort(going.rbegin(), going.rend());
    for (const std::size_t t : going)
      mesh_.triangles.erase(mesh_.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  }

  [[nodiscard]] const geometry::TriangleMesh& original() const { return original_; }

  geometry::TriangleMesh mesh_;
  geometry::TriangleMesh original_ = mesh_;
  std::mt19937 random_;
};

class RepairsDamage : public ::testing::TestWithParam<unsigned> {};

TEST_P(RepairsDamage, ToTheVolumeItWasAndOnce) {
  static const std::vector<geometry::TriangleMesh> kWhole{ball(), box(), geometry::make_organ("gallbladder")};
  for (const geometry::TriangleMesh& whole : kWhole) {
    const geometry::TriangleMesh damaged = Damage(whole, GetParam()).run();
    const RepairedSurface result = repaired(damaged, geometry::signed_volume(whole), 0.002);
    EXPECT_EQ(result.mesh.triangles.size(), whole.triangles.size());
    EXPECT_FALSE(result.repairs.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RepairsDamage, ::testing::Range(1U, 31U));

}  // namespace
}  // namespace palpate::mesh_io
