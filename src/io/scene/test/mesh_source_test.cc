// Meshes of organs' files that were read before.
#include "io/scene/mesh_source.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/content_hash.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/mesh.h"
#include "palpate/organ_cache.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

namespace fs = std::filesystem;
using palpate::test::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename T>
void write(std::ofstream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Writes an STL file [mm] over 1 MB of a ball without its first triangle, with a vertex moved through its
/// inside and out again, so that triangles intersect.
void write_damaged_ball(const fs::path& path, double radius_mm = 20.0) {
  geometry::TriangleMesh mesh = geometry::make_ball(radius_mm, 80000);
  Vec3& drawn = mesh.vertices[1000];
  const Vec3 aside = drawn.cross(Vec3(0.3, 0.5, 0.81)).normalized();
  drawn = 1.02 * radius_mm * (drawn + 0.5 * radius_mm * aside).normalized();
  std::ofstream file(path, std::ios::binary);
  file << std::string(80, ' ');
  write(file, static_cast<std::uint32_t>(mesh.triangles.size() - 1));
  for (std::size_t t = 1; t < mesh.triangles.size(); ++t) {
    file << std::string(12, '\0');
    for (const std::int32_t v : mesh.triangles[t]) {
      for (const double x : mesh.vertices[static_cast<std::size_t>(v)]) write(file, static_cast<float>(x));
    }
    file << std::string(2, '\0');
  }
}

class StoredMesh : public ::testing::Test {
 protected:
  StoredMesh() {
    write_damaged_ball(file_);
    use_organ_cache(how_, cache_);
    read_ = read();
  }

  [[nodiscard]] std::pair<contact::ReadOrgan, MeshNotes> read(
      bool with_store = true, LengthUnit unit = LengthUnit::kMillimetre) const {
    std::pair<contact::ReadOrgan, MeshNotes> result;
    LocatedString mesh;
    mesh.value = file_.string();
    mesh.where = "--organ";
    mesh.by_flag = true;
    result.first = read_organ_source(mesh, unit, with_store ? how_.store.get() : nullptr, result.second);
    return result;
  }

  void expect_as_first(const std::pair<contact::ReadOrgan, MeshNotes>& again) const {
    EXPECT_EQ(again.first.mesh.vertices, read_.first.mesh.vertices);
    EXPECT_EQ(again.first.mesh.triangles, read_.first.mesh.triangles);
    EXPECT_EQ(again.second.repairs, read_.second.repairs);
    EXPECT_EQ(again.second.remarks, read_.second.remarks);
  }

  [[nodiscard]] std::ptrdiff_t stored() const {
    return std::distance(fs::directory_iterator(cache_), fs::directory_iterator());
  }
  [[nodiscard]] fs::path only_stored() const { return fs::directory_iterator(cache_)->path(); }

  const TemporaryFolder folder_;
  const fs::path file_ = folder_ / "ball.stl";
  const fs::path cache_ = folder_ / "cache";
  contact::Preparation how_;
  std::pair<contact::ReadOrgan, MeshNotes> read_;
};

TEST_F(StoredMesh, IsTheMeshThatAFileGivesWithAllItsMessages) {
  EXPECT_THAT(read_.second.repairs,
              ElementsAre(HasSubstr("joined"), HasSubstr("closed 1 hole with 1 triangle")));
  EXPECT_THAT(read_.second.remarks, ElementsAre(HasSubstr("of triangles that go through each other")));
  expect_as_first(read(/*with_store=*/false));
  ASSERT_EQ(stored(), 1);
  const fs::path link = folder_ / "link";
  fs::create_hard_link(only_stored(), link);
  expect_as_first(read());
  EXPECT_EQ(fs::hard_link_count(link), 2U) << "the file was read again, and stored in place of the first";
}

TEST_F(StoredMesh, BelongsToOneContentAndOneUnit) {
  (void)read(true, LengthUnit::kCentimetre);
  EXPECT_EQ(stored(), 2);
  write_damaged_ball(file_, 21.0);
  const auto other = read();
  EXPECT_EQ(stored(), 3);
  EXPECT_NE(other.first.mesh.vertices, read_.first.mesh.vertices);
}

TEST_F(StoredMesh, IsReadAgainWhenItsFileIsDamaged) {
  const std::uintmax_t size = fs::file_size(only_stored());
  for (const std::uintmax_t byte : {std::uintmax_t{9}, size / 3, size - 2}) {
    std::fstream file(only_stored(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(byte));
    const int old = file.get();
    file.seekp(static_cast<std::streamoff>(byte));
    file.put(static_cast<char>(old ^ 0x10));
    file.close();
    expect_as_first(read());
  }
  fs::resize_file(only_stored(), size / 2);
  expect_as_first(read());
  EXPECT_EQ(fs::file_size(only_stored()), size);
}

TEST_F(StoredMesh, HasNoIndexThatLeadsOutsideAndOnlyFiniteVertices) {
  const ContentHash key = ContentHasher().add(1).hash();
  const auto accepted = [&](const contact::ReadOrgan& organ) {
    how_.store->store_read(key, organ);
    return how_.store->load_read(key).has_value();
  };
  EXPECT_TRUE(accepted(read_.first));
  contact::ReadOrgan organ = read_.first;
  organ.mesh.triangles[3][1] = static_cast<std::int32_t>(organ.mesh.vertices.size());
  EXPECT_FALSE(accepted(organ));
  organ = read_.first;
  organ.mesh.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(accepted(organ));
}

TEST_F(StoredMesh, OfThisVersionGivesTheseBitsAndMessages) {
  // If this fails because a mesh or a message is meant to change, raise kReadVersion (mesh_source.cc) and put
  // the new hash here: otherwise users keep what the old program read.
  ContentHasher hasher;
  hasher.add(std::span<const Vec3>(read_.first.mesh.vertices));
  hasher.add(std::span<const geometry::Triangle>(read_.first.mesh.triangles));
  for (const auto* texts : {&read_.first.repairs, &read_.first.remarks}) {
    for (const std::string& text : *texts) hasher.add(std::span<const char>(text));
  }
  EXPECT_EQ(hasher.hash().hexadecimal(), "2e42b433b93f07620d4c2f93bbb394d0");
}

}  // namespace
}  // namespace palpate::scene
