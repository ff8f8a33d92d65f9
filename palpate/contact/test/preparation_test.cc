// How an organ is prepared: its averaged normals, the cache, and what neither depends on.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "palpate/base/test/temporary_folder.h"
#include "palpate/contact/averaged_normals.h"
#include "palpate/contact/organ_surface.h"
#include "palpate/contact/test/rig.h"
#include "palpate/geometry/builtin.h"
#include "palpate/geometry/read_mesh.h"

namespace palpate::contact {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;
using palpate::test::TemporaryFolder;

constexpr double kReference = 10e-3;
constexpr double kRadius = kReference / 2.0;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

struct Surface {
  explicit Surface(TriangleMesh organ)
      : mesh(refined(organ, kReference)),
        neighbours(geometry::edge_neighbours(mesh)),
        face_normals(face_normals_of(mesh)),
        sides(find_sides(view())) {}
  [[nodiscard]] SurfaceView view() const { return {mesh, neighbours, face_normals}; }

  TriangleMesh mesh;
  std::vector<std::array<std::int32_t, 3>> neighbours;
  std::vector<Vec3> face_normals;
  Sides sides;
};

/// The rule of docs/model.md once more, written plainly: triangles within reach by a flood over a set.
Vec3 plain_rule(const Surface& surface, std::int32_t corner) {
  const Vec3 centre = surface.mesh.vertices[at(surface.mesh.triangles[at(corner / 3)][at(corner % 3)])];
  const std::int32_t side = surface.sides.of_corner[at(corner)];
  const auto corner_of = [&](std::int32_t t, std::size_t c) {
    return Vec3(surface.mesh.vertices[at(surface.mesh.triangles[at(t)][c])] - centre);
  };
  std::set<std::int32_t> reached;
  std::vector<std::int32_t> waiting;
  Vec3 reference = Vec3::Zero();
  for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (surface.sides.of_corner[3 * t + c] != side) continue;
      waiting.push_back(static_cast<std::int32_t>(t));
      reference += geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[t]);
    }
  }
  reference.normalize();
  reached.insert(waiting.begin(), waiting.end());
  Vec3 sum = Vec3::Zero();
  while (!waiting.empty()) {
    const std::int32_t t = waiting.back();
    waiting.pop_back();
    double weight = 0.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 middle = 0.5 * (corner_of(t, e) + corner_of(t, (e + 1) % 3));
      weight += std::max(0.0, 1.0 - middle.squaredNorm() / (kRadius * kRadius)) / 3.0;
    }
    const Vec3 area = 0.5 * geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[at(t)]);
    const double cosine = area.normalized().dot(reference);
    sum += weight * std::clamp((cosine - 0.5) / 0.15, 0.0, 1.0) * area;
    for (const std::int32_t next : surface.neighbours[at(t)]) {
      if (next < 0 || reached.count(next) > 0) continue;
      if (corner_of(next, 0).norm() >= kRadius && corner_of(next, 1).norm() >= kRadius &&
          corner_of(next, 2).norm() >= kRadius) {
        continue;
      }
      reached.insert(next);
      waiting.push_back(next);
    }
  }
  return sum.normalized();
}

/// The largest angle [degrees] between the fast normals and the plain rule at some sides drawn by lot.
double worst_angle(const Surface& surface, const std::vector<Vec3>& normals, int draws) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> draw(0, surface.sides.first_corner.size() - 1);
  double worst = 0.0;
  for (int i = 0; i < draws; ++i) {
    const std::size_t side = draw(random);
    if (surface.sides.first_corner[side] < 0) continue;
    const Vec3 expected = plain_rule(surface, surface.sides.first_corner[side]);
    worst = std::max(worst, (normals[side] - expected).norm() / kDegree);
  }
  return worst;
}

TriangleMesh divided(TriangleMesh mesh, int times) {
  for (int i = 0; i < times; ++i) mesh = geometry::quadruple(mesh);
  return mesh;
}

/// Every vertex moved by chance, so that nothing is regular any more.
TriangleMesh shaken(TriangleMesh mesh, double by) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, by);
  for (Vec3& vertex : mesh.vertices) vertex += Vec3(normal(random), normal(random), normal(random));
  return mesh;
}

void expect_the_rule(const char* what, const Surface& surface) {
  SCOPED_TRACE(what);
  EXPECT_LT(worst_angle(surface, normals_by_triangles(surface.view(), surface.sides, kRadius), 60), 1e-6);
  EXPECT_LT(worst_angle(surface, normals_by_clusters(surface.view(), surface.sides, kRadius), 60), 0.002);
}

TEST(AveragedNormals, AreThoseOfThePlainRuleBothWays) {
  expect_the_rule("gallbladder", Surface(divided(geometry::make_organ("gallbladder"), 1)));
  expect_the_rule("heart", Surface(geometry::make_organ("heart")));
  expect_the_rule("ball", Surface(geometry::make_ball(20e-3, 20480)));
  expect_the_rule("small ball", Surface(geometry::make_ball(3e-3, 5120)));
  expect_the_rule("block", Surface(divided(test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1), 2)));
  expect_the_rule("thin plate", Surface(divided(test::block(Vec3(30e-3, 30e-3, 1e-3), 0.1), 3)));
  expect_the_rule("shaken ball", Surface(shaken(geometry::make_ball(15e-3, 20480), 0.05e-3)));
}

TEST(AveragedNormals, ByClustersAgreeOnUnevenMeshes) {
  // Fine on one half, coarse on the other: blocks with long edges beside blocks with short ones.
  TriangleMesh organ = geometry::make_ball(20e-3, 5120);
  for (Vec3& vertex : organ.vertices) vertex.z() *= vertex.z() > 0.0 ? 1.0 : 0.05;
  expect_the_rule("flattened ball", Surface(divided(organ, 1)));
}

TEST(AveragedNormals, OfRealOrgansAgreeWithinAHundredthOfADegree) {
  const char* data = std::getenv("PALPATE_DATA");
  if (data == nullptr) {
    std::cout << "PALPATE_DATA is not set: nothing compared\n";
    return;
  }
  for (const char* name : {"gallbladder_fine.stl", "liver_openhelp.stl", "heart_openhelp.stl"}) {
    SCOPED_TRACE(name);
    const Surface surface(
        geometry::read_mesh(fs::path(data) / "organs" / name, LengthUnit::kMillimetre).mesh);
    EXPECT_LT(worst_angle(surface, normals_by_clusters(surface.view(), surface.sides, kRadius), 100), 0.01);
  }
}

/// Hash of all that is prepared, face normals too.
std::string hash_of(const OrganArrays& arrays) {
  const auto rows = [](const auto& list) { return std::span(list.data(), list.size()); };
  ContentHasher hasher;
  hasher.add(std::span<const Vec3>(arrays.mesh.vertices));
  hasher.add(std::span<const geometry::Triangle>(arrays.mesh.triangles));
  hasher.add(std::span<const geometry::Triangle>(arrays.neighbours));
  hasher.add(std::span<const Vec3>(arrays.face_normals)).add(std::span<const Vec3>(arrays.normals));
  hasher.add(std::span<const std::int32_t>(rows(arrays.row_of)));
  hasher.add(std::span<const geometry::Triangle>(arrays.side_rows));
  hasher.add(std::span<const SharpEdge>(arrays.sharp_edges));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_start));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_near));
  return hasher.hash().hexadecimal();
}

std::string prepared(const TriangleMesh& organ, const fs::path& cache = {}, double reference = kReference,
                     std::string* remark = nullptr) {
  Preparation how;
  how.cache = cache;
  if (remark != nullptr) how.remark = [remark](const std::string& words) { *remark = words; };
  return hash_of(OrganSurface(organ, reference, how).arrays());
}

TEST(Preparation, OfThisVersionGivesTheseBits) {
  // When this fails because the arrays are to change: raise kArraysVersion (organ_arrays.cc) and put the new
  // hashes here. Else caches of before are taken for the new arrays.
  EXPECT_EQ(prepared(geometry::make_ball(20e-3, 5120)), "120946d185c3a1d5dca27b1525c789cd");
  EXPECT_EQ(prepared(geometry::make_ball(20e-3, 81920)), "4c1900ea1b26f75d057e5d44773ff739");
  EXPECT_EQ(prepared(test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1)), "b70c9ed46b766360efd7e535b0cd13af");
}

TEST(Preparation, OnOneThreadGivesTheSameBits) {
  for (const int triangles : {5120, 81920}) {
    const TriangleMesh organ = geometry::make_ball(20e-3, triangles);
    const std::string on_all = prepared(organ);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(prepared(organ), on_all);
  }
}

TEST(Preparation, FromTheCacheGivesTheSameBits) {
  const TemporaryFolder folder;
  const TriangleMesh organ = test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1);
  const std::string fresh = prepared(organ);
  std::string remark;
  EXPECT_EQ(prepared(organ, folder / "new" / "cache", kReference, &remark), fresh);
  EXPECT_NE(remark.find("does not have"), std::string::npos);
  EXPECT_EQ(prepared(organ, folder / "new" / "cache", kReference, &remark), fresh);
  EXPECT_NE(remark.find("taken from the cache"), std::string::npos);
}

TEST(Preparation, OfAnotherMeshOrRadiusIsAnotherInTheCache) {
  const TemporaryFolder folder;
  TriangleMesh organ = geometry::make_ball(20e-3, 1280);
  (void)prepared(organ, folder.path());
  (void)prepared(organ, folder.path(), 2.0 * kReference);
  organ.vertices[7].x() = std::nextafter(organ.vertices[7].x(), 1.0);
  (void)prepared(organ, folder.path());
  EXPECT_EQ(folder.entries(), 3U);
}

TEST(Preparation, MakesADamagedCacheAnew) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const std::string fresh = prepared(organ, folder.path());
  const fs::path file = fs::directory_iterator(folder.path())->path();
  std::ostringstream whole;
  whole << std::ifstream(file, std::ios::binary).rdbuf();
  std::mt19937 random(9);
  for (int i = 0; i < 20; ++i) {
    std::string bytes = whole.str();
    if (i % 2 == 0) {
      bytes.resize(random() % bytes.size());
    } else {
      for (int change = 0; change < 100; ++change) {
        bytes[random() % bytes.size()] ^= static_cast<char>(1 + random() % 255);
      }
    }
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
    std::string remark;
    EXPECT_EQ(prepared(organ, folder.path(), kReference, &remark), fresh);
    EXPECT_NE(remark.find("made anew"), std::string::npos);
    EXPECT_EQ(prepared(organ, folder.path(), kReference, &remark), fresh);
    EXPECT_NE(remark.find("taken from the cache"), std::string::npos);  // it was mended
  }
}

TEST(Preparation, BelievesNoIndexThatLeadsOutside) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const OrganArrays good = OrganSurface(organ, kReference).arrays();
  const ContentHash key = organ_key(organ, kReference);
  const auto accepted = [&](const OrganArrays& arrays) {
    ArrayFileWriter writer(folder / "file", key);
    arrays.put(writer);
    EXPECT_TRUE(writer.commit());
    return OrganArrays::get(*ArrayFileReader::open(folder / "file", key)).has_value();
  };
  EXPECT_TRUE(accepted(good));
  const auto broken = [&](auto change) {
    OrganArrays arrays = good;
    change(arrays);
    return !accepted(arrays);
  };
  const auto beyond = static_cast<std::int32_t>(good.mesh.triangles.size());
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.mesh.triangles[3][1] = beyond; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.neighbours[3][1] = beyond; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.neighbours[3][1] = -2; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.row_of[5] = 0; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.sharp_start.back() = 1; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.normals.pop_back(); }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.sharp_edges.push_back({{0, beyond}, {0, 0}}); }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.sharp_edges.push_back({{0, 1}, {0, 3}}); }));
}

TEST(Preparation, WithoutAFolderThatCanBeWrittenIsNoError) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const fs::path file = folder.write("file", "not a folder");
  EXPECT_EQ(prepared(organ, file / "cache"), prepared(organ));
  EXPECT_EQ(prepared(organ, "/proc/cache"), prepared(organ));
}

TEST(Preparation, TellsHowFarItIsInRisingSharesAndItsStages) {
  Preparation how;
  std::vector<double> shares;
  std::set<std::string> stages;
  how.progress = [&](double share, const std::string& what) {
    shares.push_back(share);
    stages.insert(what);
  };
  (void)OrganSurface(geometry::make_ball(20e-3, 81920), kReference, how);
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
  (void)OrganSurface(geometry::make_ball(20e-3, 20480), kReference);
  EXPECT_LE(threads(), before);
}

TEST(Preparation, KeepsUnder110BytesATriangleBesidesTheDistances) {
  const OrganSurface surface(geometry::make_ball(20e-3, 81920), kReference);
  const OrganArrays& a = surface.arrays();
  const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  const std::size_t all = bytes(a.mesh.vertices) + bytes(a.mesh.triangles) + bytes(a.neighbours) +
                          bytes(a.face_normals) + bytes(a.normals) + bytes(a.row_of) + bytes(a.side_rows) +
                          bytes(a.sharp_edges) + bytes(a.sharp_start) + bytes(a.sharp_near);
  EXPECT_LT(static_cast<double>(all), 110.0 * static_cast<double>(a.mesh.triangles.size()));
}

}  // namespace
}  // namespace palpate::contact
