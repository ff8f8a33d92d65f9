#include <algorithm>
#include <cstring>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/test/solids.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

using test::Solid;
using test::SolidCell;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSubsetOf;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

struct MshForm {
  std::string version;  // 2.2, 4.0 or 4.1
  bool is_binary = false;
  bool is_big = false;  // byte order
};

std::vector<MshForm> all_msh_forms() {
  std::vector<MshForm> forms;
  for (const char* version : {"2.2", "4.0", "4.1"}) {
    forms.push_back({version, false, false});
    forms.push_back({version, true, false});
    forms.push_back({version, true, true});
  }
  return forms;
}

/// Writes MSH files, independently of the reader. Nodes have the tags 10, 13, 16, ...
class MshWriter final {
 public:
  explicit MshWriter(const MshForm& form) : form_(form) {
    text("$MeshFormat\n" + form.version + (form.is_binary ? " 1 8\n" : " 0 8\n"));
    if (form.is_binary) {
      number(std::int32_t{1});
      text("\n");
    }
    text("$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"liver\"\n$EndPhysicalNames\n");
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

  void nodes(const std::vector<Vec3>& points) {
    text("$Nodes\n");
    if (form_.version == "2.2") {
      text(std::to_string(points.size()) + "\n");
      for (std::size_t n = 0; n < points.size(); ++n) {
        number(static_cast<std::int32_t>(tag(n)));
        coordinates(points[n], {});
      }
    } else {  // two blocks; the first is a curve with a parameter
      const std::size_t first = points.size() / 2;
      for (const std::size_t value : {std::size_t{2}, points.size()}) number(std::uint64_t{value});
      if (form_.version == "4.1")
        for (const std::size_t n : {std::size_t{0}, points.size() - 1}) number(tag(n));
      line();
      node_block(points, 0, first, 1, true);
      node_block(points, first, points.size(), 3, false);
    }
    text("\n$EndNodes\n");
  }

  void elements(const std::vector<SolidCell>& cells) {
    text("$Elements\n");
    if (form_.version == "2.2") {
      text(std::to_string(cells.size()) + "\n");
    } else {
      for (int n = 0; n < 2; ++n) number(std::uint64_t{cells.size()});
      if (form_.version == "4.1")
        for (const std::size_t value : {std::size_t{1}, cells.size()}) number(std::uint64_t{value});
      line();
    }
    for (std::size_t n = 0; n < cells.size(); ++n) element(cells[n], n);
    text("\n$EndElements\n");
  }

 private:
  static std::uint64_t tag(std::size_t n) { return 10 + 3 * n; }

  void text(const std::string& words) { bytes_ += words; }
  void line() {
    if (!form_.is_binary) bytes_ += '\n';
  }

  template <typename T>
  void number(T value) {
    if (!form_.is_binary) {
      std::ostringstream out;
      out.precision(17);
      out << value << ' ';
      return text(out.str());
    }
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (form_.is_big) std::reverse(raw.begin(), raw.end());
    bytes_ += raw;
  }

  void coordinates(const Vec3& p, const std::vector<double>& parameters) {
    for (const double x : p) number(x);
    for (const double u : parameters) number(u);
    line();
  }

  void node_block(const std::vector<Vec3>& points, std::size_t begin, std::size_t end, int dimension,
                  bool is_parametric) {
    const int entity = 7;
    number(std::int32_t{form_.version == "4.1" ? dimension : entity});
    number(std::int32_t{form_.version == "4.1" ? entity : dimension});
    number(std::int32_t{is_parametric ? 1 : 0});
    number(std::uint64_t{end - begin});
    line();
    if (form_.version == "4.1") {
      for (std::size_t n = begin; n < end; ++n) number(tag(n));
      line();
    }
    for (std::size_t n = begin; n < end; ++n) {
      if (form_.version == "4.0") number(static_cast<std::int32_t>(tag(n)));
      coordinates(points[n], is_parametric ? std::vector<double>{0.5} : std::vector<double>{});
    }
  }

  void element(const SolidCell& cell, std::size_t n) {
    const auto own_tag = static_cast<std::int32_t>(n + 1);
    if (form_.version == "2.2") {
      const std::vector<std::int32_t> head = form_.is_binary
                                                 ? std::vector<std::int32_t>{cell.gmsh, 1, 2, own_tag, 1, 1}
                                                 : std::vector<std::int32_t>{own_tag, cell.gmsh, 2, 1, 1};
      for (const std::int32_t value : head) number(value);
      for (const std::int32_t v : cell.nodes)
        number(static_cast<std::int32_t>(tag(static_cast<std::size_t>(v))));
    } else {
      for (const std::int32_t value : {3, 1, cell.gmsh}) number(value);
      number(std::uint64_t{1});
      line();
      if (form_.version == "4.0") {
        number(own_tag);
        for (const std::int32_t v : cell.nodes)
          number(static_cast<std::int32_t>(tag(static_cast<std::size_t>(v))));
      } else {
        number(static_cast<std::uint64_t>(own_tag));
        for (const std::int32_t v : cell.nodes) number(tag(static_cast<std::size_t>(v)));
      }
    }
    line();
  }

  MshForm form_;
  std::string bytes_;
};

std::string msh(const MshForm& form, const std::vector<Vec3>& points, const std::vector<SolidCell>& cells) {
  MshWriter writer(form);
  writer.nodes(points);
  writer.elements(cells);
  return writer.bytes();
}

ImportedMesh read_msh_bytes(const std::string& bytes) { return read_msh({"a.msh", MeshFormat::kMsh, bytes}); }

TEST(Msh, TakesTheSurfaceOfSolidElementsOrientedOutwards) {
  for (const MshForm& form : all_msh_forms()) {
    for (const Solid& solid : test::solids()) {
      if (solid.cells.front().gmsh == 0) continue;
      SCOPED_TRACE(solid.name + ", version " + form.version + (form.is_binary ? ", binary" : ", text"));
      const ImportedMesh read = read_msh_bytes(msh(form, solid.points, solid.cells));
      EXPECT_EQ(read.mesh.triangles.size(), solid.triangles);
      EXPECT_NEAR(geometry::signed_volume(read.mesh), solid.volume, 1e-12);
      EXPECT_THAT(read.mesh.vertices, IsSubsetOf(solid.points));
      const MeshFindings findings = findings_of(read.mesh);
      EXPECT_TRUE(findings.closed && findings.manifold);
      EXPECT_TRUE(findings.defects.empty());
    }
  }
}

TEST(Msh, IsReadByItsEndingWithItsUnitAndReportsWhatWasDone) {
  const palpate::test::TemporaryFolder folder;
  const Solid solid = test::solids().front();
  const LoadedMesh loaded = read_mesh(
      folder.write("a.MSH", msh({"4.1", true, false}, solid.points, solid.cells)), LengthUnit::kCentimetre);
  EXPECT_NEAR(loaded.findings.volume, 0.5e-6, 1e-18);
  EXPECT_THAT(loaded.findings.repairs, ElementsAre("took the surface of 2 solid cells: 6 faces"));
}

TEST(Msh, KeepsNoNodesFromWithinASolid) {
  // A cube of 2 x 2 x 2 hexahedra: one of its 27 nodes is inside.
  std::vector<Vec3> points;
  for (int n = 0; n < 27; ++n) points.emplace_back(n % 3, n / 3 % 3, n / 9);
  std::vector<SolidCell> cells;
  for (const std::int32_t a : {0, 1, 3, 4, 9, 10, 12, 13})
    cells.push_back({12, 5, {a, a + 1, a + 4, a + 3, a + 9, a + 10, a + 13, a + 12}});
  const ImportedMesh read = read_msh_bytes(msh({"4.1", true, false}, points, cells));
  EXPECT_EQ(read.mesh.vertices.size(), 26U);
  EXPECT_EQ(read.mesh.triangles.size(), 48U);
  EXPECT_NEAR(geometry::signed_volume(read.mesh), 8.0, 1e-12);
}

TEST(Msh, ReportsThatCurvedElementsAreTakenByTheirCorners) {
  const Solid solid = test::solids().back();
  EXPECT_THAT(
      read_msh_bytes(msh({"2.2", false, false}, solid.points, solid.cells)).repairs,
      ElementsAre("used only the corners of 1 curved cell", "took the surface of 1 solid cell: 4 faces"));
}

TEST(Msh, TakesTrianglesAndQuadrilateralsAsASurfaceWhereNothingIsSolid) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<SolidCell> cells{{0, 1, {0, 1}}, {0, 2, {0, 1, 4}}, {0, 3, {0, 3, 2, 1}}};
  for (const MshForm& form : all_msh_forms()) {
    const ImportedMesh read = read_msh_bytes(msh(form, points, cells));
    ASSERT_EQ(read.mesh.triangles.size(), 3U);
    EXPECT_EQ(read.mesh.triangles.front(), (geometry::Triangle{0, 1, 4}));
    EXPECT_THAT(read.repairs, ElementsAre("cut 1 polygon into triangles", "dropped 1 line or point"));
  }
}

TEST(Msh, LeavesOutFlatElementsBesideSolidOnes) {
  const Solid solid = test::solids().front();
  std::vector<SolidCell> cells = solid.cells;
  cells.push_back({5, 2, {1, 2, 3}});  // the interface of two regions
  const ImportedMesh read = read_msh_bytes(msh({"2.2", false, false}, solid.points, cells));
  EXPECT_EQ(read.mesh.triangles.size(), 6U);
  EXPECT_THAT(read.repairs, Contains("skipped 1 flat cell among solid cells"));
}

TEST(Msh, IsRefusedWhereverItIsCutOff) {
  const Solid solid = test::solids().front();
  for (const MshForm& form : all_msh_forms()) {
    const std::string whole = msh(form, solid.points, solid.cells);
    const std::size_t end = whole.rfind("$EndElements") + std::string("$EndElements").size();
    for (std::size_t size = 0; size < end; ++size) {
      SCOPED_TRACE(size);
      EXPECT_THAT([&] { (void)read_msh_bytes(whole.substr(0, size)); },
                  ThrowsMessage<InputError>(AllOf(StartsWith("a.msh, "), Not(HasSubstr("\n")))));
    }
  }
}

TEST(Msh, IsRefusedOrReadWhicheverByteIsChanged) {
  std::mt19937 random(5);
  const Solid solid = test::solids()[7];
  for (const MshForm& form : all_msh_forms()) {
    const std::string whole = msh(form, solid.points, solid.cells);
    for (int n = 0; n < 500; ++n) {
      std::string damaged = whole;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      try {
        const ImportedMesh some = read_msh_bytes(damaged);
        for (const geometry::Triangle& t : some.mesh.triangles) {
          for (const std::int32_t v : t) ASSERT_LT(static_cast<std::size_t>(v), some.mesh.vertices.size());
        }
      } catch (const InputError& error) {
        ASSERT_THAT(error.what(), StartsWith("a.msh, "));
      }
    }
  }
}

void expect_msh_refused(const std::string& bytes, const std::string& place, const std::string& words) {
  EXPECT_THAT([&] { (void)read_msh_bytes(bytes); },
              ThrowsMessage<InputError>(AllOf(StartsWith("a.msh, " + place + ": "), HasSubstr(words))));
}

TEST(Msh, ReportsLineFieldAndValueOfWhatItRefuses) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string nodes = head + "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
  expect_msh_refused("$NOD\n1\n", "line 1", "\"$NOD\": must be $MeshFormat here");
  expect_msh_refused("$MeshFormat\n3.0 0 8\n", "line 2", "version \"3.0\": must be 2.0 to 2.2, 4.0 or 4.1");
  expect_msh_refused("$MeshFormat\n2.2 2 8\n", "line 2", "file type \"2\": must be 0 (text) or 1 (binary)");
  expect_msh_refused("$MeshFormat\n4.1 0 4\n", "line 2", "data size \"4\": must be 8");
  expect_msh_refused(std::string("$MeshFormat\n2.2 1 8\n\2\0\0\0\n", 25), "byte 20",
                     "byte order is 2, must be 1");
  expect_msh_refused(head + "what\n", "line 4", "must be a section here");
  expect_msh_refused(head + "$Elements\n1\n", "line 4", "$Elements come before $Nodes");
  expect_msh_refused(nodes, "line 10", "has no $Elements");
  expect_msh_refused(head + "$Nodes\nx\n", "line 5", "\"x\" is not a number of nodes");
  expect_msh_refused(head + "$Nodes\n999999999999\n", "line 5", "declares 999999999999 nodes, more than");
  expect_msh_refused(head + "$Nodes\n20\n1 0 0 0\n", "line 5", "20 nodes do not fit in the");
  expect_msh_refused(nodes + nodes.substr(head.size()), "line 10", "$Nodes come twice");
  expect_msh_refused(head + "$" + std::string(64, 'a') + "\n", "line 4",
                     "section \"$" + std::string(39, 'a') + "...\": its name must have at most 64 bytes");
  expect_msh_refused(head + "$Nodes\n1\n1 0 nan 0\n", "line 6", "vertex 1 is not finite");
  expect_msh_refused(head + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n", "line 4", "node 1 comes twice");
  expect_msh_refused(nodes + "$Elements\n1\n1 2 0 1 2 4\n$EndElements\n", "line 12",
                     "node 4 is not in $Nodes");
  expect_msh_refused(nodes + "$Elements\n1\n1 92 0 1 2 3\n", "line 12", "elements of type 92 are not read");
  expect_msh_refused(nodes + "$Elements\n1\n1 2 0 1 2\n$EndElements\n", "line 13",
                     "\"$EndElements\" is not a whole number");
  expect_msh_refused(nodes + "$Elements\n1\n1 2 0 1 2 3\n1 2 0 1 2 3\n", "line 13",
                     "must be $EndElements here");
}

// Tags that are equal modulo the size of a hash table: lookups in one would take minutes.
TEST(Msh, IsReadWhateverTheTagsOfItsNodesHaveInCommon) {
  constexpr std::int64_t kNodes = 500'000;
  constexpr std::int64_t kTableSize = 520'241;
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 500000 1 1\n2 1 0 500000\n";
  for (std::int64_t n = 0; n < kNodes; ++n) text += std::to_string(1 + n * kTableSize) + "\n";
  for (std::int64_t n = 0; n < kNodes; ++n) text += std::to_string(n) + " " + std::to_string(n % 7) + " 0\n";
  text += "$EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 " + std::to_string(1 + kTableSize) + " " +
          std::to_string(1 + 499'999 * kTableSize) + "\n$EndElements\n";
  const palpate::test::TemporaryFolder folder;
  const geometry::TriangleMesh mesh = read_mesh(folder.write("a.msh", text), LengthUnit::kMetre).mesh;
  ASSERT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.vertices[1], Vec3(1, 1, 0));
  EXPECT_EQ(mesh.vertices[2], Vec3(499'999, 499'999 % 7, 0));
}

TEST(Msh, RefusesBlocksThatDoNotAddUpToWhatIsDeclared) {
  const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n";
  expect_msh_refused(head + "1 3 1 3\n2 1 0 4\n1 2 3 4 5 6 7 8 9\n", "line 6",
                     "a block declares 4 nodes, of 3 that are left");
  expect_msh_refused(head + "1 2 1 2\n2 1 0 1\n1\n0 0 0\n$EndNodes\n", "line 8",
                     "declares 2 nodes, its blocks have 1");
  const std::string nodes = head + "1 3 1 3\n2 1 0 3\n1 2 3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n";
  expect_msh_refused(nodes + "$Elements\n1 1 1 1\n2 1 2 2\n1 1 2 3\n", "line 14",
                     "a block declares 2 elements, of 1 that are left");
}

}  // namespace
}  // namespace palpate::mesh_io
