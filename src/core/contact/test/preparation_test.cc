// Preparation of an organ: averaged normals, the cache, and independence of the results from both.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include <gtest/gtest.h>

#include "core/base/index.h"
#include "core/contact/averaged_normals.h"
#include "core/contact/organ_surface.h"
#include "core/contact/test/rig.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::contact {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;
using palpate::test::TemporaryFolder;

constexpr double kPreparedReference = 10e-3;
constexpr double kRadius = kPreparedReference / 2.0;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct Surface {
  explicit Surface(const TriangleMesh& organ)
      : mesh(refined(organ, kPreparedReference)),
        neighbours(geometry::edge_neighbours(mesh)),
        face_normals(face_normals_of(mesh)),
        sides(find_sides(view())) {}
  [[nodiscard]] SurfaceView view() const { return {mesh, neighbours, face_normals}; }

  TriangleMesh mesh;
  std::vector<std::array<std::int32_t, 3>> neighbours;
  std::vector<Vec3> face_normals;
  Sides sides;
};

/// An independent, plain version of the rule in docs/model.md: triangles within the radius by a flood over a
/// set.
class PlainRule final {
 public:
  /// For `centre` on the surface; `first` are the triangles there.
  PlainRule(const Surface& surface, const Vec3& centre, std::vector<std::int32_t> first,
            double radius = kRadius)
      : surface_(surface),
        centre_(centre),
        radius_(radius),
        fan_(first),
        reached_(first.begin(), first.end()) {
    for (const std::int32_t t : first) reference_ += area_of(t);
    reference_.normalize();
    while (!first.empty()) {
      const std::int32_t t = first.back();
      first.pop_back();
      for (const std::int32_t next : surface_.neighbours[at(t)]) {
        if (next < 0 || reached_.count(next) > 0 || !has_corner_in_reach(next)) continue;
        reached_.insert(next);
        first.push_back(next);
      }
    }
  }

  /// As for a fine mesh: faces are turned from the mean within 2 mm, a fifth of the reference radius.
  PlainRule& turned_from_mean_within(double radius) {
    reference_ = PlainRule(surface_, centre_, fan_, radius).normal();
    return *this;
  }

  /// The normal at centre + `aside` for the same triangles.
  [[nodiscard]] Vec3 normal(const Vec3& aside = Vec3::Zero()) const {
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t t : reached_) {
      double weight = 0.0;
      for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 middle = 0.5 * (corner(t, e) + corner(t, (e + 1) % 3)) - (centre_ + aside);
        weight += std::max(0.0, 1.0 - middle.squaredNorm() / (radius_ * radius_)) / 3.0;
      }
      const double cosine = area_of(t).normalized().dot(reference_);
      sum += weight * std::clamp((cosine - 0.5) / 0.15, 0.0, 1.0) * area_of(t);
    }
    return sum.normalized();
  }

 private:
  [[nodiscard]] const Vec3& corner(std::int32_t t, std::size_t c) const {
    return surface_.mesh.vertices[at(surface_.mesh.triangles[at(t)][c])];
  }
  [[nodiscard]] Vec3 area_of(std::int32_t t) const {
    return 0.5 * geometry::area_vector_doubled(surface_.mesh, surface_.mesh.triangles[at(t)]);
  }
  [[nodiscard]] bool has_corner_in_reach(std::int32_t t) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if ((corner(t, c) - centre_).norm() < radius_) return true;
    }
    return false;
  }

  const Surface& surface_;
  Vec3 centre_;
  double radius_;
  std::vector<std::int32_t> fan_;
  std::set<std::int32_t> reached_;
  Vec3 reference_ = Vec3::Zero();
};

PlainRule rule_at_side(const Surface& surface, std::int32_t side) {
  std::vector<std::int32_t> fan;
  for (std::size_t i = 0; i < surface.sides.of_corner.size(); ++i) {
    if (surface.sides.of_corner[i] == side) fan.push_back(static_cast<std::int32_t>(i / 3));
  }
  const std::int32_t corner = surface.sides.first_corner[at(side)];
  return {surface, surface.mesh.vertices[at(surface.mesh.triangles[at(corner / 3)][at(corner % 3)])], fan};
}

/// Deviation of the fast normals from the plain rule at randomly chosen sides.
struct Deviation {
  double angle = 0.0;  // largest [degrees]
  double slope = 0.0;  // 90th percentile of the slope's error along the surface, times kRadius
};

Deviation deviation(const Surface& surface, const std::vector<NormalAndSlope>& normals, int draws) {
  constexpr double kStep = 1e-8;  // m
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> draw(0, surface.sides.first_corner.size() - 1);
  Deviation worst;
  std::vector<double> slopes;
  for (int i = 0; i < draws; ++i) {
    const std::size_t side = draw(random);
    if (surface.sides.first_corner[side] < 0) continue;
    const PlainRule rule = rule_at_side(surface, static_cast<std::int32_t>(side));
    const Vec3 expected = rule.normal();
    worst.angle = std::max(worst.angle, (normals[side].normal - expected).norm() / kDegree);
    const Vec3 along = expected.unitOrthogonal();
    for (const Vec3& way : {along, Vec3(expected.cross(along))}) {
      const Vec3 slope = (rule.normal(kStep * way) - rule.normal(-kStep * way)) / (2.0 * kStep);
      slopes.push_back((normals[side].slope * way - slope).norm() * kRadius);
    }
  }
  std::sort(slopes.begin(), slopes.end());
  worst.slope = slopes[slopes.size() * 9 / 10];
  return worst;
}

TriangleMesh divided(TriangleMesh mesh, int times) {
  for (int i = 0; i < times; ++i) mesh = geometry::subdivide(mesh);
  return mesh;
}

/// Moves every vertex randomly, so that the mesh has no regular pattern.
TriangleMesh shaken(TriangleMesh mesh, double by) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, by);
  for (Vec3& vertex : mesh.vertices) vertex += Vec3(normal(random), normal(random), normal(random));
  return mesh;
}

void expect_the_rule(const char* what, const Surface& surface) {
  SCOPED_TRACE(what);
  const Deviation off = deviation(surface, averaged_normals(surface.view(), surface.sides, kRadius, 0.0), 30);
  EXPECT_LT(off.angle, 1e-6);
  EXPECT_LT(off.slope, 1e-6);
}

TEST(AveragedNormals, AtEverySideAreThoseOfThePlainRule) {
  expect_the_rule("gallbladder", Surface(divided(geometry::make_organ("gallbladder"), 1)));
  expect_the_rule("heart", Surface(geometry::make_organ("heart")));
  expect_the_rule("ball", Surface(geometry::make_ball(20e-3, 20480)));
  expect_the_rule("small ball", Surface(geometry::make_ball(3e-3, 5120)));
  expect_the_rule("block", Surface(divided(test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1), 2)));
  expect_the_rule("thin plate", Surface(divided(test::block(Vec3(30e-3, 30e-3, 1e-3), 0.1), 3)));
  expect_the_rule("shaken ball", Surface(shaken(geometry::make_ball(15e-3, 20480), 0.05e-3)));
  // Fine on one half and coarse on the other.
  TriangleMesh organ = geometry::make_ball(20e-3, 5120);
  for (Vec3& vertex : organ.vertices) vertex.z() *= vertex.z() > 0.0 ? 1.0 : 0.05;
  expect_the_rule("flattened ball", Surface(divided(organ, 1)));
}

/// Angles [degrees] between normals from samples and the plain rule for fine meshes, sorted.
std::vector<double> angles_from_samples(const Surface& surface, int draws) {
  const double spacing = sample_spacing_for(surface.view(), surface.sides, kRadius);
  EXPECT_GT(spacing, 0.0);
  const auto normals = averaged_normals(surface.view(), surface.sides, kRadius, spacing);
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> draw(0, surface.sides.first_corner.size() - 1);
  std::vector<double> angles;
  while (angles.size() < static_cast<std::size_t>(draws)) {
    const std::size_t side = draw(random);
    const Vec3 expected =
        rule_at_side(surface, static_cast<std::int32_t>(side)).turned_from_mean_within(2e-3).normal();
    angles.push_back((normals[side].normal - expected).norm() / kDegree);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

TEST(AveragedNormals, FromSamplesAreNearlyThoseOfThePlainRule) {
  const auto nearly = [](const char* what, const TriangleMesh& mesh, double median, double nine_in_ten) {
    SCOPED_TRACE(what);
    const std::vector<double> angles = angles_from_samples(Surface(mesh), 60);
    EXPECT_LT(angles[30], median);
    EXPECT_LT(angles[54], nine_in_ten);
  };
  nearly("ball", geometry::make_ball(20e-3, 81920), 0.02, 0.05);
  nearly("shaken ball", shaken(geometry::make_ball(20e-3, 81920), 0.02e-3), 0.1, 0.3);
  nearly("gallbladder", divided(geometry::make_organ("gallbladder"), 3), 0.03, 1.0);
}

TEST(AveragedNormals, FromSamplesKeepBothSidesOfSharpEdges) {
  const Surface surface(divided(test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1), 6));
  const double spacing = sample_spacing_for(surface.view(), surface.sides, kRadius);
  ASSERT_GT(spacing, 0.0);
  const auto normals = averaged_normals(surface.view(), surface.sides, kRadius, spacing);
  for (std::size_t corner = 0; corner < surface.sides.of_corner.size(); ++corner) {
    const Vec3& face = surface.face_normals[corner / 3];
    ASSERT_LT((normals[at(surface.sides.of_corner[corner])].normal - face).norm(), 1e-9) << corner;
  }
}

TEST(AveragedNormals, FromSamplesAreNotChangedByATriangleWithoutArea) {
  const Surface whole(shaken(geometry::make_ball(20e-3, 81920), 0.02e-3));
  TriangleMesh mesh = whole.mesh;
  const auto [a, b, c] = mesh.triangles[0];
  const auto same_place = static_cast<std::int32_t>(mesh.vertices.size());  // as a
  mesh.vertices.push_back(Vec3(mesh.vertices[at(a)]));
  mesh.triangles[0] = {same_place, b, c};
  mesh.triangles.push_back({a, same_place, c});
  mesh.triangles.push_back({a, b, same_place});
  const Surface split(mesh);
  const auto expected = averaged_normals(whole.view(), whole.sides, kRadius, kRadius / 4.0);
  const auto normals = averaged_normals(split.view(), split.sides, kRadius, kRadius / 4.0);
  std::vector<double> angles;
  for (std::size_t v = 0; v < whole.mesh.vertices.size(); ++v) {
    if ((mesh.vertices[v] - mesh.vertices[at(a)]).norm() > kRadius) continue;
    angles.push_back((normals[v].normal - expected[v].normal).norm() / kDegree);
  }
  std::sort(angles.begin(), angles.end());
  ASSERT_GT(angles.size(), 100U);
  EXPECT_LT(angles[angles.size() * 9 / 10], 0.1);
}

TEST(AveragedNormals, FromSamplesHaveTheSlopeOfABall) {
  // On a ball of radius r a normal turns by 1/r per metre.
  const Surface surface(geometry::make_ball(20e-3, 81920));
  const auto normals = averaged_normals(surface.view(), surface.sides, kRadius, kRadius / 4.0);
  for (std::size_t side = 0; side < normals.size(); side += 997) {
    const Vec3 along = normals[side].normal.unitOrthogonal();
    EXPECT_NEAR(along.dot(normals[side].slope * along), 50.0, 2.5) << side;
  }
}

/// Deviation of normals inside triangles from the plain rule on a finer mesh of the same shape, at random
/// points: 75th percentile [degrees].
struct Within {
  double found = 0.0;
  double straight = 0.0;  // of linear interpolation between the corners' normals
};

Within deviation_within(const TriangleMesh& organ) {
  const Surface surface(organ);
  const Surface fine(divided(surface.mesh, 2));
  const geometry::SignedDistance distance(fine.mesh);
  const OrganSurface prepared(organ, kPreparedReference);
  const std::vector<std::int32_t> sharp_start = prepared.arrays().sharp_start;
  const std::vector<NormalAndSlope> corners = averaged_normals(surface.view(), surface.sides, kRadius, 0.0);
  std::mt19937 random(5);
  std::uniform_int_distribution<std::size_t> draw(0, surface.mesh.triangles.size() - 1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<double> found;
  std::vector<double> straight;
  while (found.size() < 100) {
    const std::size_t t = draw(random);
    // sides blend here
    if (sharp_start[t] < sharp_start[t + 1]) continue;
    double b = share(random);
    double c = share(random);
    if (b + c > 1.0) std::tie(b, c) = std::pair(1.0 - b, 1.0 - c);
    const std::array<double, 3> weights{1.0 - b - c, b, c};
    Vec3 place = Vec3::Zero();
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      place += weights[k] * surface.mesh.vertices[at(surface.mesh.triangles[t][k])];
      mean += weights[k] * corners[at(surface.sides.of_corner[3 * t + k])].normal;
    }
    const Vec3 expected = PlainRule(fine, place, {distance.nearest(place).triangle}).normal();
    const Vec3 normal = prepared.normal_at({place, static_cast<std::int32_t>(t)});
    found.push_back((normal - expected).norm() / kDegree);
    straight.push_back((mean.normalized() - expected).norm() / kDegree);
  }
  const auto three_in_four = [](std::vector<double>& list) {
    std::sort(list.begin(), list.end());
    return list[list.size() * 3 / 4];
  };
  return {three_in_four(found), three_in_four(straight)};
}

TEST(AveragedNormals, InsideATriangleAreNearlyThoseOfTheRuleThere) {
  for (const char* name : {"gallbladder", "heart"}) {
    const Within within = deviation_within(geometry::make_organ(name));
    EXPECT_LT(within.found, 0.1) << name;
    EXPECT_LT(within.found, 0.7 * within.straight) << name;
  }
}

TEST(AveragedNormals, OfTwoTrianglesAreOneOnTheirEdge) {
  const TriangleMesh organ = geometry::make_organ("gallbladder");
  const OrganSurface surface(organ, kPreparedReference);
  const geometry::TriangleMesh& mesh = surface.mesh();
  const auto neighbours = surface.arrays().neighbours;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t other = neighbours[t][e];
      const Vec3 place = 0.3 * mesh.vertices[at(mesh.triangles[t][e])] +
                         0.7 * mesh.vertices[at(mesh.triangles[t][(e + 1) % 3])];
      const Vec3 here = surface.normal_at({place, static_cast<std::int32_t>(t)});
      ASSERT_LT((here - surface.normal_at({place, other})).norm(), 1e-9);
    }
  }
}

/// Hash of all prepared arrays, face normals included.
std::string hash_of(const OrganArrays& arrays) {
  const auto rows = [](const auto& list) { return std::span(list.data(), list.size()); };
  ContentHasher hasher;
  hasher.add(std::span<const Vec3>(arrays.mesh.vertices));
  hasher.add(std::span<const geometry::Triangle>(arrays.mesh.triangles));
  hasher.add(std::span<const geometry::Triangle>(arrays.neighbours));
  hasher.add(std::span<const Vec3>(face_normals_of(arrays.mesh))).add(std::span<const Vec3>(arrays.normals));
  hasher.add(std::span<const NormalBends>(arrays.bends));
  hasher.add(std::span<const std::int32_t>(rows(arrays.row_of)));
  hasher.add(std::span<const geometry::Triangle>(arrays.side_rows));
  hasher.add(std::span<const SharpEdge>(arrays.sharp_edges));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_start));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_near));
  return hasher.hash().hexadecimal();
}

std::string prepared(const TriangleMesh& organ) {
  return hash_of(OrganSurface(organ, kPreparedReference).arrays());
}

TEST(Preparation, OfThisVersionGivesTheseBits) {
  // If this fails because the arrays are meant to change, raise kArraysVersion (organ_arrays.cc) and put the
  // new hashes here. Otherwise old caches would be used as new ones.
  EXPECT_EQ(prepared(geometry::make_ball(20e-3, 5120)), "a389ba5ad14bc7c9327c591247397fe1");
  EXPECT_EQ(prepared(geometry::make_ball(20e-3, 81920)), "13eda17a2d435ad0cfb652527524dd58");
  EXPECT_EQ(prepared(test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1)), "6f8411271de850e061a71785101e13ce");
}

double longest_edge(const geometry::TriangleMesh& mesh) {
  double longest = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) {
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[e])];
      longest = std::max(longest, (mesh.vertices[static_cast<std::size_t>(t[(e + 1) % 3])] - a).norm());
    }
  }
  return longest;
}

TEST(Preparation, RefinesALargeLiversAreaToAFifthOfTheReferenceRadius) {
  const geometry::TriangleMesh organ = geometry::make_box(Vec3::Constant(150e-3), 50e-3);  // 0.135 m^2
  EXPECT_LE(longest_edge(refined(organ, 10e-3)), 2e-3);
}

TEST(Preparation, MakesNoMoreTrianglesOfALargerMeshHoweverLargeAndOfHoweverSmallARadius) {
  for (const double size : {0.3, 30.0}) {
    for (const double radius : {10e-3, 1e-3}) {
      const geometry::TriangleMesh mesh = refined(geometry::make_ball(0.5 * size, 1280), radius);
      EXPECT_LE(mesh.triangles.size(), 250'000U) << size << " m, " << radius;
      EXPECT_GE(mesh.triangles.size(), 100'000U) << size << " m, " << radius;
    }
  }
}

TEST(Preparation, TellsHowFarItIsInRisingSharesAndItsStages) {
  Preparation how;
  std::vector<double> shares;
  std::set<std::string> stages;
  how.progress = [&](double share, const std::string& what) {
    shares.push_back(share);
    stages.insert(what);
  };
  (void)OrganSurface(geometry::make_ball(20e-3, 81920), kPreparedReference, how);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
  EXPECT_GT(shares.size(), 10U);
  for (const char* stage : {"refinement", "distances", "neighbours", "normals", "edges"}) {
    EXPECT_EQ(stages.count(stage), 1U) << stage;
  }
}

TEST(Preparation, LeavesNoThreadBehind) {
  const auto threads = [] { return std::distance(fs::directory_iterator("/proc/self/task"), {}); };
  const auto before = threads();
  (void)OrganSurface(geometry::make_ball(20e-3, 20480), kPreparedReference);
  EXPECT_LE(threads(), before);
}

TEST(Preparation, KeepsUnder110BytesATriangleBesidesTheDistances) {
  const OrganSurface surface(geometry::make_ball(20e-3, 81920), kPreparedReference);
  const OrganArrays a = surface.arrays();
  const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  const std::size_t all = bytes(a.mesh.vertices) + bytes(a.mesh.triangles) + bytes(a.neighbours) +
                          bytes(a.normals) + bytes(a.bends) + bytes(a.row_of) + bytes(a.side_rows) +
                          bytes(a.sharp_edges) + bytes(a.sharp_start) + bytes(a.sharp_near);
  EXPECT_LT(static_cast<double>(all), 110.0 * static_cast<double>(a.mesh.triangles.size()));
}

}  // namespace
}  // namespace palpate::contact
