// The cache of prepared organs in a folder.
#include "io/scene/organ_cache.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include "core/base/index.h"
#include "core/contact/organ_surface.h"
#include "core/contact/stiffness_map.h"
#include "core/contact/test/rig.h"
#include "core/deform/organ_response.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/mesh.h"
#include "palpate/organ_cache.h"
#include "palpate/support.h"

namespace palpate::scene {
namespace {

namespace fs = std::filesystem;
using contact::organ_key;
using contact::OrganArrays;
using contact::OrganSurface;
using geometry::TriangleMesh;
using palpate::test::TemporaryFolder;

constexpr double kCachedReference = 10e-3;

std::string hash_of(const OrganArrays& arrays) {
  const auto rows = [](const auto& list) { return std::span(list.data(), list.size()); };
  ContentHasher hasher;
  hasher.add(std::span<const Vec3>(arrays.mesh.vertices));
  hasher.add(std::span<const geometry::Triangle>(arrays.mesh.triangles));
  hasher.add(std::span<const geometry::Triangle>(arrays.neighbours));
  hasher.add(std::span<const Vec3>(contact::face_normals_of(arrays.mesh)))
      .add(std::span<const Vec3>(arrays.normals));
  hasher.add(std::span<const contact::NormalBends>(arrays.bends));
  hasher.add(std::span<const std::int32_t>(rows(arrays.row_of)));
  hasher.add(std::span<const geometry::Triangle>(arrays.side_rows));
  hasher.add(std::span<const contact::SharpEdge>(arrays.sharp_edges));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_start));
  hasher.add(std::span<const std::int32_t>(arrays.sharp_near));
  return hasher.hash().hexadecimal();
}

std::string prepared(const TriangleMesh& organ, const fs::path& cache = {},
                     double reference = kCachedReference, std::string* remark = nullptr) {
  contact::Preparation how;
  use_organ_cache(how, cache, [remark](const std::string& words) {
    if (remark != nullptr) *remark = words;
  });
  return hash_of(OrganSurface(organ, reference, how).arrays());
}

TEST(PreparedOrgan, OnOneThreadGivesTheSameBits) {
  for (const int triangles : {5120, 81920}) {
    const TriangleMesh organ = geometry::make_ball(20e-3, triangles);
    const std::string on_all = prepared(organ);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(prepared(organ), on_all);
  }
}

TEST(OrganCache, GivesTheSameBits) {
  const TemporaryFolder folder;
  const TriangleMesh organ = contact::test::block(Vec3(60e-3, 40e-3, 20e-3), 0.1);
  const std::string fresh = prepared(organ);
  std::string remark;
  EXPECT_EQ(prepared(organ, folder / "new" / "cache", kCachedReference, &remark), fresh);
  EXPECT_NE(remark.find("does not have"), std::string::npos);
  EXPECT_EQ(prepared(organ, folder / "new" / "cache", kCachedReference, &remark), fresh);
  EXPECT_NE(remark.find("taken from the cache"), std::string::npos);
}

/// Sum of a map's factors, and the number of files of maps in the cache.
std::pair<double, int> mapped(const fs::path& cache, double factor) {
  contact::Preparation how;
  use_organ_cache(how, cache);
  const OrganSurface organ(geometry::make_ball(20e-3, 1280), kCachedReference, how);
  const std::vector<model::StiffnessPoint> points{{Vec3(0.0, 0.0, 20e-3), factor},
                                                  {Vec3(20e-3, 0.0, 0.0), 1.0}};
  const contact::StiffnessMap map(organ, points, how.store.get());
  double sum = 0.0;
  for (std::int32_t t = 0; t < 1280; ++t) {
    const Vec3& place = organ.mesh().vertices[at(organ.mesh().triangles[at(t)][0])];
    sum += map.factor_at({place, t}).value;
  }
  const auto files = std::count_if(fs::directory_iterator(cache), {},
                                   [](const auto& file) { return file.path().extension() == ".factors"; });
  return {sum, static_cast<int>(files)};
}

TEST(OrganCache, KeepsAStiffnessMapForEachOfItsPoints) {
  const TemporaryFolder folder;
  const auto [first, one_file] = mapped(folder.path(), 2.0);
  EXPECT_EQ(one_file, 1);
  EXPECT_EQ(mapped(folder.path(), 2.0), std::pair(first, 1));
  const auto [other, two_files] = mapped(folder.path(), 3.0);
  EXPECT_GT(other, first);
  EXPECT_EQ(two_files, 2);
}

TEST(OrganCache, TakesAStiffnessMapFromItsFile) {
  const TemporaryFolder folder;
  contact::Preparation how;
  use_organ_cache(how, folder.path());
  const OrganSurface organ(geometry::make_ball(20e-3, 1280), kCachedReference, how);
  const std::vector<model::StiffnessPoint> points{{Vec3(0.0, 0.0, 20e-3), 2.0}};
  const ContentHash key = contact::StiffnessMap::key(organ.mesh(), points);
  const std::size_t vertices = organ.mesh().vertices.size();
  how.store->store_factors(key, std::vector<double>(vertices, 7.0));
  EXPECT_EQ(
      contact::StiffnessMap(organ, points, how.store.get()).factor_at({organ.mesh().vertices[0], 0}).value,
      7.0);
  // Values that no map can have are computed again.
  how.store->store_factors(key, std::vector<double>(vertices, -1.0));
  EXPECT_NEAR(
      contact::StiffnessMap(organ, points, how.store.get()).factor_at({organ.mesh().vertices[0], 0}).value,
      2.0, 0.1);
  how.store->store_factors(key, std::vector<double>(vertices + 1, 7.0));
  EXPECT_NEAR(
      contact::StiffnessMap(organ, points, how.store.get()).factor_at({organ.mesh().vertices[0], 0}).value,
      2.0, 0.1);
}

// --- the response of a supported organ

using deform::OrganResponse;

geometry::Support bed(double share) {
  geometry::Support support;
  support.bed = geometry::Bed{-Vec3::UnitZ(), share};
  return support;
}

TriangleMesh bar() { return geometry::make_box(Vec3(0.12, 0.012, 0.012), 4e-3); }

/// Displacements of a bar under a force on its upper side.
OrganResponse::Displacements moved_by_force(const geometry::Support& support,
                                            const contact::OrganStore* store,
                                            const TriangleMesh& organ = bar()) {
  const OrganResponse response(organ, support, store);
  return response.under(response.load_at(Vec3(0.0, 0.0, 6e-3), Vec3::UnitZ(), 5e-3))[2];
}

std::vector<fs::path> responses_in(const fs::path& cache) {
  std::vector<fs::path> files;
  for (const auto& file : fs::directory_iterator(cache))
    if (file.path().extension() == ".response") files.push_back(file.path());
  return files;
}

ContentHash key_in_name(const fs::path& file) {
  const std::string name = file.stem().string();
  return {{std::stoull(name.substr(0, 16), nullptr, 16), std::stoull(name.substr(16), nullptr, 16)}};
}

TEST(OrganCache, TakesAResponseFromItsFileWithTheSameBits) {
  const TemporaryFolder folder;
  contact::Preparation how;
  use_organ_cache(how, folder.path());
  const OrganResponse::Displacements fresh = moved_by_force(bed(0.3), nullptr);
  EXPECT_TRUE(moved_by_force(bed(0.3), how.store.get()) == fresh);
  ASSERT_EQ(responses_in(folder.path()).size(), 1U);
  EXPECT_TRUE(moved_by_force(bed(0.3), how.store.get()) == fresh);
  const ContentHash key = key_in_name(responses_in(folder.path()).front());
  const contact::ResponseArrays kept = how.store->load_response(key).value();
  contact::ResponseArrays still = kept;
  std::fill(still.entries.begin(), still.entries.end(), std::int16_t{0});
  how.store->store_response(key, still);
  for (const Eigen::Vector4f& u : moved_by_force(bed(0.3), how.store.get())) ASSERT_EQ(u.norm(), 0.0F);
  // Numbers that are not of these cells are computed again.
  const auto is_computed_again = [&](auto change) {
    contact::ResponseArrays wrong = still;
    change(wrong);
    how.store->store_response(key, wrong);
    return moved_by_force(bed(0.3), how.store.get()) == fresh;
  };
  EXPECT_TRUE(is_computed_again([](contact::ResponseArrays& wrong) { wrong.entries.pop_back(); }));
  EXPECT_TRUE(is_computed_again([](contact::ResponseArrays& wrong) { wrong.scale.push_back(1.0F); }));
  EXPECT_TRUE(is_computed_again([](contact::ResponseArrays& wrong) { wrong.cell_edge = 1e-9; }));
  EXPECT_TRUE(is_computed_again([](contact::ResponseArrays& wrong) { wrong.cell_edge = std::nan(""); }));
  EXPECT_TRUE(is_computed_again([](contact::ResponseArrays& wrong) { wrong.cell_edge = HUGE_VAL; }));
}

TEST(OrganCache, KeepsAResponseForEachMeshAndSupport) {
  const TemporaryFolder folder;
  contact::Preparation how;
  use_organ_cache(how, folder.path());
  geometry::Support held = bed(0.3);
  const auto files_after = [&](const geometry::Support& support, const TriangleMesh& organ) {
    (void)moved_by_force(support, how.store.get(), organ);
    return responses_in(folder.path()).size();
  };
  TriangleMesh organ = bar();
  EXPECT_EQ(files_after(held, organ), 1U);
  EXPECT_EQ(files_after(bed(0.31), organ), 2U);
  held.attachments.push_back({Vec3(20e-3, 0.0, 6e-3), 5e-3});
  EXPECT_EQ(files_after(held, organ), 3U);
  held.attachments.back().radius = 6e-3;
  EXPECT_EQ(files_after(held, organ), 4U);
  std::swap(held.attachments, held.painted);
  EXPECT_EQ(files_after(held, organ), 5U);
  held.bed.reset();
  EXPECT_EQ(files_after(held, organ), 6U);
  held.faces = geometry::HeldFaces{Vec3::UnitZ()};
  EXPECT_EQ(files_after(held, organ), 7U);
  organ.vertices[7].x() = std::nextafter(organ.vertices[7].x(), 1.0);
  EXPECT_EQ(files_after(held, organ), 8U);
}

TEST(OrganCache, ComputesAResponseAgainWhoseFileIsDamaged) {
  const TemporaryFolder folder;
  contact::Preparation how;
  use_organ_cache(how, folder.path());
  const OrganResponse::Displacements fresh = moved_by_force(bed(0.3), how.store.get());
  const fs::path file = responses_in(folder.path()).front();
  const auto size = fs::file_size(file);
  fs::resize_file(file, size - 1000);
  EXPECT_TRUE(moved_by_force(bed(0.3), how.store.get()) == fresh);
  EXPECT_EQ(fs::file_size(file), size);  // replaced
  std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
  bytes.seekg(static_cast<std::streamoff>(size / 2));
  const auto flipped = static_cast<char>(bytes.get() ^ 0x40);
  bytes.seekp(static_cast<std::streamoff>(size / 2));
  bytes.put(flipped);
  bytes.close();
  EXPECT_FALSE(how.store->load_response(key_in_name(file)).has_value());
  EXPECT_TRUE(moved_by_force(bed(0.3), how.store.get()) == fresh);
  EXPECT_TRUE(how.store->load_response(key_in_name(file)).has_value());
}

TEST(OrganCache, KeepsAnotherMeshOrRadiusApart) {
  const TemporaryFolder folder;
  TriangleMesh organ = geometry::make_ball(20e-3, 1280);
  (void)prepared(organ, folder.path());
  (void)prepared(organ, folder.path(), 2.0 * kCachedReference);
  organ.vertices[7].x() = std::nextafter(organ.vertices[7].x(), 1.0);
  (void)prepared(organ, folder.path());
  EXPECT_EQ(folder.entries(), 3U);
}

TEST(OrganCache, ReplacesADamagedFile) {
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
    EXPECT_EQ(prepared(organ, folder.path(), kCachedReference, &remark), fresh);
    EXPECT_NE(remark.find("computed again"), std::string::npos);
    EXPECT_EQ(prepared(organ, folder.path(), kCachedReference, &remark), fresh);
    EXPECT_NE(remark.find("taken from the cache"), std::string::npos);  // the damaged file was replaced
  }
}

TEST(OrganCache, BelievesNoIndexThatLeadsOutside) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const OrganArrays good = OrganSurface(organ, kCachedReference).arrays();
  const ContentHash key = organ_key(organ, kCachedReference);
  const auto accepted = [&](const OrganArrays& arrays) {
    ArrayFileWriter writer(folder / "file", key);
    put(arrays, writer);
    EXPECT_TRUE(writer.commit());
    return get(*ArrayFileReader::open(folder / "file", key)).has_value();
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
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.bends.pop_back(); }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.normals[3] *= 5.0; }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.normals[3].x() = std::nan(""); }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.sharp_edges.push_back({{0, beyond}, {0, 0}}); }));
  EXPECT_TRUE(broken([&](OrganArrays& a) { a.sharp_edges.push_back({{0, 1}, {0, 3}}); }));
}

TEST(OrganCache, BelievesNoVertexOutsideTheOrganOrNotFinite) {
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const ContentHash key = organ_key(organ, kCachedReference);
  const std::string fresh = prepared(organ);
  for (const double x : {21e-3, std::nan("")}) {
    const TemporaryFolder folder;
    OrganArrays arrays = OrganSurface(organ, kCachedReference).arrays();
    arrays.mesh.vertices[7].x() = x;
    ArrayFileWriter writer(folder / (key.hexadecimal() + ".organ"), key);
    put(arrays, writer);
    ASSERT_TRUE(writer.commit());
    EXPECT_EQ(prepared(organ, folder.path()), fresh);
  }
}

TEST(OrganCache, MakesItsFolderAndFilesForItsUserAlone) {
  const TemporaryFolder folder;
  (void)prepared(geometry::make_ball(20e-3, 320), folder / "cache");
  EXPECT_EQ(fs::status(folder / "cache").permissions(), fs::perms::owner_all);
  const fs::path file = fs::directory_iterator(folder / "cache")->path();
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(OrganCache, UsesNoFolderThatOthersOwnOrMayWriteTo) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const fs::path cache = folder / "cache";
  (void)prepared(organ, cache);
  const auto why_distrusted = [&] {
    contact::Preparation how;
    std::string why;
    use_organ_cache(how, cache, {}, [&why](const std::string& words) { why = words; });
    EXPECT_NE(how.store != nullptr, !why.empty());
    return why;
  };
  EXPECT_EQ(why_distrusted(), "");
  fs::permissions(cache, fs::perms::group_write, fs::perm_options::add);
  EXPECT_NE(why_distrusted().find("other users may write to it (chmod go-w"), std::string::npos);
  fs::permissions(cache, fs::perms::group_write, fs::perm_options::remove);
  if (geteuid() != 0) return;  // only root can change a folder's owner
  ASSERT_EQ(chown(cache.c_str(), 1234, 1234), 0);
  EXPECT_NE(why_distrusted().find("belongs to another user"), std::string::npos);
}

TEST(OrganCache, UsesNoFileThatOthersOwnOrMayWriteTo) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const std::string fresh = prepared(organ, folder.path());
  const fs::path file = fs::directory_iterator(folder.path())->path();
  fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
  std::string remark;
  EXPECT_EQ(prepared(organ, folder.path(), kCachedReference, &remark), fresh);
  EXPECT_NE(remark.find("computed again"), std::string::npos);
  if (geteuid() != 0) return;  // only root can change a file's owner
  ASSERT_EQ(chown(file.c_str(), 1234, 1234), 0);
  EXPECT_EQ(prepared(organ, folder.path(), kCachedReference, &remark), fresh);
  EXPECT_NE(remark.find("computed again"), std::string::npos);
}

TEST(OrganCache, WithoutAFolderThatCanBeWrittenIsNoError) {
  const TemporaryFolder folder;
  const TriangleMesh organ = geometry::make_ball(20e-3, 320);
  const fs::path file = folder.write("file", "not a folder");
  EXPECT_EQ(prepared(organ, file / "cache"), prepared(organ));
  EXPECT_EQ(prepared(organ, "/proc/cache"), prepared(organ));
}

}  // namespace
}  // namespace palpate::scene
