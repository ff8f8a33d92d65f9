#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/test/solids.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

ImportedMesh read(const std::string& bytes) { return read_vtk({"a.vtk", MeshFormat::kVtk, bytes}); }

/// Boxes as solid cells, and before them polygons that take nearly all the time that a file's polygons may.
std::string large_polygons_and_boxes(int boxes) {
  constexpr std::array kCorners{512, 512, 512,
                                512, 512, 361};  // 1/6 of their cubes: 119.7 of 120 million steps
  std::string text = "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS ";
  text += std::to_string(8 * boxes) + " float\n";
  for (int box = 0; box < boxes; ++box) {
    for (const char* corner : {"0 0", "1 0", "1 1", "0 1"})
      text += std::string(corner) + ' ' + std::to_string(2 * box) + '\n';
    for (const char* corner : {"0 0", "1 0", "1 1", "0 1"})
      text += std::string(corner) + ' ' + std::to_string(2 * box + 1) + '\n';
  }
  int numbers = 9 * boxes;
  for (const int corners : kCorners) numbers += corners + 1;
  text += "CELLS " + std::to_string(boxes + 6) + ' ' + std::to_string(numbers) + '\n';
  for (const int corners : kCorners) {
    text += std::to_string(corners);
    for (int corner = 0; corner < corners; ++corner) text += ' ' + std::to_string(corner);
    text += '\n';
  }
  for (int box = 0; box < boxes; ++box) {
    text += '8';
    for (int corner = 0; corner < 8; ++corner) text += ' ' + std::to_string(8 * box + corner);
    text += '\n';
  }
  text += "CELL_TYPES " + std::to_string(boxes + 6) + '\n';
  for (int i = 0; i < 6; ++i) text += "7\n";
  for (int i = 0; i < boxes; ++i) text += "12\n";
  return text;
}

TEST(Vtk, PolygonsThatSolidCellsReplaceDoNotCountForTheTimeOfThoseThatAreCut) {
  constexpr int kBoxes = 6000;  // 36,000 faces of 10 steps
  EXPECT_EQ(read(large_polygons_and_boxes(kBoxes)).mesh.triangles.size(), 12U * kBoxes);
}

/// The form of a file.
struct Form {
  bool is_binary = false;
  bool has_offsets = false;  // version 5.1
  bool is_double = false;
  bool is_grid = false;
};

/// Writes legacy VTK files, independently of the reader.
class Writer final {
 public:
  explicit Writer(Form form) : form_(form) {
    text("# vtk DataFile Version " + std::string(form.has_offsets ? "5.1" : "4.2") + "\na title\n" +
         (form.is_binary ? "BINARY" : "ASCII") + "\nDATASET " +
         (form.is_grid ? "UNSTRUCTURED_GRID" : "POLYDATA") + "\n");
  }

  void text(const std::string& words) { bytes_ += words; }

  template <typename T>
  void number(T value) {
    if (!form_.is_binary) {
      std::ostringstream out;
      out.precision(17);
      out << value;
      bytes_ += out.str() + (++numbers_ % 9 == 0 ? "\n" : " ");
      return;
    }
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    bytes_.append(raw.rbegin(), raw.rend());
  }

  void points(const std::vector<Vec3>& all) {
    text("POINTS " + std::to_string(all.size()) + (form_.is_double ? " double\n" : " float\n"));
    for (const Vec3& p : all) {
      for (int k = 0; k < 3; ++k) {
        if (form_.is_double) {
          number(p[k]);
        } else {
          number(static_cast<float>(p[k]));
        }
      }
    }
    text("\n");
  }

  void cells(const std::string& name, const std::vector<std::vector<std::int32_t>>& all) {
    std::size_t corners = 0;
    for (const auto& cell : all) corners += cell.size();
    if (!form_.has_offsets) {
      text(name + " " + std::to_string(all.size()) + " " + std::to_string(all.size() + corners) + "\n");
      for (const auto& cell : all) {
        number(static_cast<std::int32_t>(cell.size()));
        for (const std::int32_t v : cell) number(v);
      }
      return text("\n");
    }
    text(name + " " + std::to_string(all.size() + 1) + " " + std::to_string(corners) +
         "\nOFFSETS vtktypeint64\n");
    std::int64_t offset = 0;
    number(offset);
    for (const auto& cell : all) number(offset += static_cast<std::int64_t>(cell.size()));
    text("\nCONNECTIVITY vtktypeint64\n");
    for (const auto& cell : all) {
      for (const std::int32_t v : cell) number(std::int64_t{v});
    }
    text("\n");
  }

  void cell_types(const std::vector<std::int32_t>& types) {
    text("CELL_TYPES " + std::to_string(types.size()) + "\n");
    for (const std::int32_t type : types) number(type);
    text("\n");
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Form form_;
  std::string bytes_;
  int numbers_ = 0;
};

std::vector<Form> all_forms() {
  std::vector<Form> forms;
  for (int n = 0; n < 16; ++n) forms.push_back({(n & 1) != 0, (n & 2) != 0, (n & 4) != 0, (n & 8) != 0});
  return forms;
}

std::vector<std::vector<std::int32_t>> lists(const std::vector<geometry::Triangle>& triangles) {
  std::vector<std::vector<std::int32_t>> all;
  for (const geometry::Triangle& t : triangles) all.emplace_back(t.begin(), t.end());
  return all;
}

std::string written(const geometry::TriangleMesh& mesh, const Form& form) {
  Writer writer(form);
  writer.points(mesh.vertices);
  writer.cells(form.is_grid ? "CELLS" : "POLYGONS", lists(mesh.triangles));
  if (form.is_grid) writer.cell_types(std::vector<std::int32_t>(mesh.triangles.size(), 5));
  return writer.bytes();
}

geometry::TriangleMesh random_mesh(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-100.0, 100.0);
  geometry::TriangleMesh mesh;
  const std::size_t vertices = 3 + random() % 40;
  for (std::size_t n = 0; n < vertices; ++n)
    mesh.vertices.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  for (std::size_t n = 1 + random() % 60; n > 0; --n) {
    const auto any = [&] { return static_cast<std::int32_t>(random() % vertices); };
    mesh.triangles.push_back({any(), any(), any()});
  }
  return mesh;
}

TEST(Vtk, ReadsInEveryFormWhatWasWritten) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const geometry::TriangleMesh mesh = random_mesh(seed);
    for (const Form& form : all_forms()) {
      const ImportedMesh read_back = read(written(mesh, form));
      ASSERT_EQ(read_back.mesh.triangles, mesh.triangles);
      ASSERT_THAT(read_back.repairs, IsEmpty());
      ASSERT_EQ(read_back.mesh.vertices.size(), mesh.vertices.size());
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        for (int k = 0; k < 3; ++k) {
          const double x = mesh.vertices[v][k];
          const double want = form.is_double ? x : static_cast<double>(static_cast<float>(x));
          ASSERT_EQ(read_back.mesh.vertices[v][k], want)
              << form.is_binary << form.has_offsets << form.is_double << form.is_grid;
        }
      }
    }
  }
}

TEST(Vtk, IsReadByItsEndingWithItsUnit) {
  const palpate::test::TemporaryFolder folder;
  geometry::TriangleMesh ball = geometry::make_ball(20.0, 320);
  const LoadedMesh loaded =
      read_mesh(folder.write("ball.VTK", written(ball, {true, true, true, false})), LengthUnit::kMillimetre);
  EXPECT_TRUE(loaded.findings.closed);
  EXPECT_EQ(loaded.mesh.triangles, ball.triangles);
  EXPECT_NEAR(geometry::bounds(loaded.mesh).high.x(), 1e-3 * geometry::bounds(ball).high.x(), 1e-15);
}

TEST(Vtk, TakesStripsApartWithEverySecondTriangleTurned) {
  for (const Form& form : all_forms()) {
    Writer writer(form);
    writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}});
    writer.cells(form.is_grid ? "CELLS" : "TRIANGLE_STRIPS", {{0, 1, 2, 3, 4}});
    if (form.is_grid) writer.cell_types({6});
    const ImportedMesh strip = read(writer.bytes());
    EXPECT_THAT(strip.mesh.triangles, ElementsAre(geometry::Triangle{0, 1, 2}, geometry::Triangle{1, 3, 2},
                                                  geometry::Triangle{2, 3, 4}));
    EXPECT_THAT(strip.repairs, ElementsAre("took 1 triangle strip apart"));
    for (const geometry::Triangle& t : strip.mesh.triangles)
      EXPECT_GT(geometry::area_vector_doubled(strip.mesh, t).z(), 0.0);
  }
}

TEST(Vtk, CutsPolygonsUpWhateverTheirShape) {
  // An L of area 3; a fan from its first corner would leave it.
  for (const Form& form : all_forms()) {
    Writer writer(form);
    writer.points({{2, 1, 0}, {2, 0, 0}, {2, 2, 0}, {0, 0, 0}, {0, 2, 0}, {1, 1, 0}, {1, 2, 0}});
    writer.cells(form.is_grid ? "CELLS" : "POLYGONS", {{4, 3, 1, 0, 5, 6}});
    if (form.is_grid) writer.cell_types({7});
    const ImportedMesh cut = read(writer.bytes());
    ASSERT_EQ(cut.mesh.triangles.size(), 4U);
    double area = 0.0;
    for (const geometry::Triangle& t : cut.mesh.triangles) {
      EXPECT_GT(geometry::area_vector_doubled(cut.mesh, t).z(), 0.0);
      area += 0.5 * geometry::area_vector_doubled(cut.mesh, t).norm();
    }
    EXPECT_NEAR(area, 3.0, 1e-12);
    EXPECT_THAT(cut.repairs, ElementsAre("cut 1 polygon into triangles"));
  }
}

TEST(Vtk, ReadsPixelsAsTheSquaresTheyAre) {
  Writer writer({false, false, false, true});
  writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  writer.cells("CELLS", {{0, 1, 2, 3}, {0, 1, 3, 2}});
  writer.cell_types({8, 9});
  const ImportedMesh squares = read(writer.bytes());
  ASSERT_EQ(squares.mesh.triangles.size(), 4U);
  for (const geometry::Triangle& t : squares.mesh.triangles)
    EXPECT_NEAR(geometry::area_vector_doubled(squares.mesh, t).z(), 1.0, 1e-12);
}

TEST(Vtk, TakesTheSurfaceOfSolidCellsOrientedOutwards) {
  for (const Form& form : all_forms()) {
    if (!form.is_grid) continue;
    for (const test::Solid& solid : test::solids()) {
      SCOPED_TRACE(solid.name);
      std::vector<std::vector<std::int32_t>> cells;
      std::vector<std::int32_t> types;
      for (const test::SolidCell& cell : solid.cells) {
        cells.push_back(cell.nodes);
        types.push_back(cell.vtk);
      }
      Writer writer(form);
      writer.points(solid.points);
      writer.cells("CELLS", cells);
      writer.cell_types(types);
      const ImportedMesh surface = read(writer.bytes());
      EXPECT_EQ(surface.mesh.triangles.size(), solid.triangles);
      EXPECT_NEAR(geometry::signed_volume(surface.mesh), solid.volume, 1e-12);
      EXPECT_TRUE(findings_of(surface.mesh).closed && findings_of(surface.mesh).manifold);
    }
  }
}

TEST(Vtk, RefusesACellWithoutTheNodesOfItsType) {
  Writer writer({false, false, false, true});
  writer.points(test::box_points());
  writer.cells("CELLS", {{0, 1, 2, 3}, {0, 1, 2, 3, 4}});
  writer.cell_types({10, 12});
  EXPECT_THAT([&] { (void)read(writer.bytes()); },
              ThrowsMessage<InputError>(HasSubstr("cell 1: a hexahedron has 5 points, must have 8")));
}

TEST(Vtk, PassesOverAllThatIsNothingToASurface) {
  for (const Form& form : all_forms()) {
    if (form.is_grid) continue;
    Writer writer(form);
    writer.text("FIELD FieldData 2\nTime 1 1 double\n");
    writer.number(0.5);
    writer.text("\nnames 2 3 unsigned_char\n");
    for (int n = 0; n < 6; ++n) {
      if (form.is_binary) {
        writer.number(std::uint8_t{7});
      } else {
        writer.text("7 ");
      }
    }
    writer.text("\n");
    writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    writer.text("METADATA\nINFORMATION 1\nNAME L2_NORM LOCATION vtkDataArray\nDATA 2 0 1\n\n");
    writer.cells("VERTICES", {{0}, {1}});
    writer.cells("LINES", {{0, 1, 2}});
    writer.cells("POLYGONS", {{0, 1, 2}});
    writer.text("CELL_DATA 1\nSCALARS x float\nLOOKUP_TABLE default\nanything at all");
    const ImportedMesh one = read(writer.bytes());
    EXPECT_THAT(one.mesh.triangles, ElementsAre(geometry::Triangle{0, 1, 2}));
    EXPECT_THAT(one.repairs, ElementsAre("dropped 3 lines or points"));
  }
}

/// A string as VTK writes it in a binary file: the first two bits say how many bytes its length takes.
std::string with_length(const std::string& text) {
  const std::size_t n = text.size();
  const auto byte = [](std::size_t value) { return static_cast<char>(value & 0xffU); };
  if (n < 64) return std::string{byte(0xc0 + n)} + text;
  if (n < 16384) return std::string{byte(0x80 + n / 256), byte(n)} + text;
  return std::string{byte(0x40), byte(n / 65536), byte(n / 256), byte(n)} + text;
}

TEST(Vtk, SkipsStringsAndBitsOfFieldDataWhereverTheyStand) {
  const std::vector<std::string> strings{"LPS",
                                         "",
                                         "a%20b%0A",
                                         std::string(63, 'x'),
                                         std::string(64, 'y'),
                                         std::string(16383, 'z'),
                                         std::string(16384, '3')};
  for (const Form& form : all_forms()) {
    const auto string_array = [&](Writer& writer, const std::string& type) {
      writer.text("SPACE 1 " + std::to_string(strings.size()) + " " + type + "\n");
      for (const std::string& text : strings) writer.text(form.is_binary ? with_length(text) : text + "\n");
      writer.text(form.is_binary ? "\nMETADATA\nINFORMATION 0\n\n" : "METADATA\nINFORMATION 0\n\n");
    };
    const auto field = [&](Writer& writer) {
      writer.text("FIELD FieldData 5\n");
      string_array(writer, "string");
      string_array(writer, "utf8_string");
      writer.text("kinds 1 2 variant\n13 POINTS%203\n10 -1.5\n");
      writer.text("NULL_ARRAY\nflags 3 3 bit\n");
      writer.text(form.is_binary ? std::string("\xff\x80\n", 3) : "1 1 1 1 1 1 1 1 1\n");
    };
    Writer writer(form);
    field(writer);
    writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    field(writer);
    writer.cells(form.is_grid ? "CELLS" : "POLYGONS", {{0, 1, 2}});
    if (form.is_grid) writer.cell_types({5});
    field(writer);
    writer.text("CELL_DATA 1\n");
    field(writer);
    EXPECT_THAT(read(writer.bytes()).mesh.triangles, ElementsAre(geometry::Triangle{0, 1, 2}));
  }
}

TEST(Vtk, SkipsABinaryStringWhoseLengthTakesEightBytes) {
  Writer writer({true, false, false, false});
  writer.text("FIELD FieldData 1\nSPACE 1 1 string\n");
  writer.text(std::string(7, '\0') + "\3LPS\n");
  writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  writer.cells("POLYGONS", {{0, 1, 2}});
  EXPECT_EQ(read(writer.bytes()).mesh.triangles.size(), 1U);
}

TEST(Vtk, RefusesStringsThatTheFileCannotHold) {
  const std::string head = "# vtk DataFile Version 4.2\na title\nBINARY\nDATASET POLYDATA\nFIELD f 1\n";
  const auto refuses = [&](const std::string& rest, const std::string& words) {
    EXPECT_THAT([&] { (void)read(head + rest); },
                ThrowsMessage<InputError>(AllOf(StartsWith("a.vtk, byte "), HasSubstr(words))));
  };
  refuses("a 1 1 string\n\xff" + std::string(61, 'x'),
          "63 bytes of a string of FIELD a do not fit in the 61");
  refuses("a 1 1 string\n\x3f\xff\xff\xff\xff\xff\xff\xff", "bytes of a string of FIELD a do not fit");
  refuses("a 1 1 string\n\x80", "ends in FIELD a");
  refuses("a 40 40 string\n\xc0", "1600 strings of FIELD a do not fit");
}

TEST(Vtk, BeginsWithAByteOrderMark) {
  const std::string whole = written(random_mesh(3), {});
  EXPECT_EQ(read("\xEF\xBB\xBF" + whole).mesh.triangles, read(whole).mesh.triangles);
}

TEST(Vtk, IsRefusedOrReadWhereverItIsCutOff) {
  const geometry::TriangleMesh mesh = random_mesh(7);
  for (const Form& form : all_forms()) {
    const std::string whole = written(mesh, form);
    std::size_t read_ones = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      try {
        (void)read(whole.substr(0, size));
        ++read_ones;
      } catch (const InputError& error) {
        ASSERT_THAT(error.what(), AllOf(StartsWith("a.vtk, "), Not(HasSubstr("\n"))));
      }
    }
    // Complete except for the last spaces or digits, or cut off before the first cell.
    EXPECT_LE(read_ones, 100U);
  }
}

TEST(Vtk, IsRefusedOrReadWhicheverByteIsChanged) {
  std::mt19937 random(5);
  const geometry::TriangleMesh mesh = random_mesh(11);
  for (const Form& form : all_forms()) {
    const std::string whole = written(mesh, form);
    for (int n = 0; n < 500; ++n) {
      std::string damaged = whole;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      try {
        const ImportedMesh some = read(damaged);
        for (const geometry::Triangle& t : some.mesh.triangles) {
          for (const std::int32_t v : t) ASSERT_LT(static_cast<std::size_t>(v), some.mesh.vertices.size());
        }
      } catch (const InputError& error) {
        ASSERT_THAT(error.what(), StartsWith("a.vtk, "));
      }
    }
  }
}

void expect_refused(const std::string& bytes, const std::string& place, const std::string& words) {
  EXPECT_THAT([&] { (void)read(bytes); },
              ThrowsMessage<InputError>(AllOf(StartsWith("a.vtk, " + place + ": "), HasSubstr(words))));
}

const std::string kHead = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\n";  // four lines
const std::string kPoints = "POINTS 3 float\n0 0 0\n1 0 0\n0 1 0\n";                       // four more

TEST(Vtk, ReportsLineFieldAndValueOfWhatItRefuses) {
  expect_refused("<?xml version=\"1.0\"?>\n", "line 1", "save it as legacy VTK");
  expect_refused("# vtk DataFile Version 9.0\n", "line 1", "version \"9.0\"");
  expect_refused("# vtk DataFile Version 3.0\ntitle\nTEXT\n", "line 3", "ASCII or BINARY");
  expect_refused("# vtk DataFile Version 3.0\ntitle\nASCII\nFILE\n", "line 4", "DATASET");
  expect_refused("# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET STRUCTURED_POINTS\n", "line 4",
                 "DATASET STRUCTURED_POINTS is no surface");
  expect_refused(kHead, "line 5", "no POINTS");
  expect_refused(kHead + "CELLS 1 2\n", "line 5", "\"CELLS\" is not a part");
  expect_refused(kHead + "POINTS x float\n", "line 5", "\"x\" is not a number of points");
  expect_refused(kHead + "POINTS -1 float\n", "line 5", "\"-1\" is not a number of points");
  expect_refused(kHead + "POINTS 999999999999 float\n", "line 5", "declares 999999999999 points");
  expect_refused(kHead + "POINTS 20 float\n", "line 5", "60 numbers of POINTS do not fit");
  expect_refused(kHead + "POINTS 3 int\n", "line 5", "float or double");
  expect_refused(kHead + "POINTS 3 real\n", "line 5", "\"real\" is not a type of numbers");
  expect_refused(kHead + "POINTS 1 float\n0 nan 0\n", "line 6", "vertex 1 is not finite");
  expect_refused(kHead + "POINTS 1 double\n0 1e300 0\n", "line 6", "vertex 1 is not finite");
  expect_refused(kHead + "POINTS 1 float\n0 a.b 0\n", "line 6", "vertex 1: \"a.b\" is not a number");
  expect_refused(kHead + kPoints + kPoints, "line 9", "POINTS come twice");
  expect_refused(kHead + "POLYGONS 1 4\n3 0 1 2\n", "line 5", "POLYGONS come before POINTS");
  expect_refused(kHead + kPoints + "POLYGONS 1 4\n3 0 1 3\n", "line 10",
                 "POLYGONS: vertex index 3 is out of range: the file has 3");
  expect_refused(kHead + kPoints + "POLYGONS 1 4\n3 0 -1 2\n", "line 10", "vertex index -1 is out of range");
  expect_refused(kHead + kPoints + "POLYGONS 1 4\n4 0 1 2\n", "line 10", "cell 0 of POLYGONS has 4 corners");
  expect_refused(kHead + kPoints + "POLYGONS 1 5\n3 0 1 2 0\n", "line 10",
                 "declares 5 numbers, its cells have 4");
  expect_refused(kHead + kPoints + "POLYGONS 2 4\n3 0 1 2\n", "line 10",
                 "fewer numbers than its 2 cells need");
  expect_refused(kHead + kPoints + "POLYGONS 1 4\n3 0 1\n", "line 11", "truncated: ends in POLYGONS");
  expect_refused(kHead + kPoints + "QUADS 1 4\n", "line 9", "\"QUADS\" is not a part");
}

TEST(Vtk, ReportsTheByteInABinaryFile) {
  Writer writer({true, false, false, false});
  writer.points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::size_t begin = writer.bytes().size() + std::string("POLYGONS 1 4\n").size();
  writer.cells("POLYGONS", {{0, 1, 9}});
  expect_refused(writer.bytes(), "byte " + std::to_string(begin + 12), "vertex index 9 is out of range");
}

TEST(Vtk, RefusesBadOffsetsAndCellTypes) {
  const std::string head = "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET POLYDATA\n" + kPoints;
  const std::string offsets = "POLYGONS 2 3\nOFFSETS vtktypeint64\n";
  expect_refused(head + offsets + "1 3\n", "line 11", "offset 0 of POLYGONS is 1, must be 0");
  expect_refused(head + offsets + "0 4\n", "line 11", "offset 1 of POLYGONS is 4, must be 0 to 3");
  expect_refused(head + offsets + "0 2\n", "line 11", "the last offset of POLYGONS is 2, must be 3");
  expect_refused(head + offsets + "0 3\n0 1 2\n", "line 12", "must be CONNECTIVITY");
  expect_refused(head + "POLYGONS 2 3\nOFFSETS float\n", "line 10", "must be vtktypeint64 or int");
  const std::string grid = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n" + kPoints +
                           "CELLS 1 4\n3 0 1 2\n";
  expect_refused(grid, "line 11", "CELLS but no CELL_TYPES");
  expect_refused(grid + "CELL_TYPES 2\n5 5\n", "line 11", "CELL_TYPES has 2 cells, CELLS 1");
  expect_refused(grid + "CELL_TYPES 1\n15\n", "line 12", "cell 0 is of type 15: must be 1 to 14");
}

TEST(Vtk, RefusesPolygonsThatWouldTakeTooLong) {
  const auto with_polygon = [](std::size_t corners, std::size_t copies) {
    Writer writer({});
    std::vector<std::int32_t> loop;
    std::vector<Vec3> points;
    for (std::size_t n = 0; n < corners; ++n) {
      points.emplace_back(static_cast<double>(n), static_cast<double>(n * n), 0.0);
      loop.push_back(static_cast<std::int32_t>(n));
    }
    writer.points(points);
    writer.cells("POLYGONS", std::vector<std::vector<std::int32_t>>(copies, loop));
    return writer.bytes();
  };
  EXPECT_EQ(read(with_polygon(512, 1)).mesh.triangles.size(), 510U);
  EXPECT_THAT([&] { (void)read(with_polygon(513, 1)); },
              ThrowsMessage<InputError>(HasSubstr("cell 0: a polygon of 513 corners: at most 512")));
  EXPECT_THAT([&] { (void)read(with_polygon(512, 6)); },
              ThrowsMessage<InputError>(HasSubstr("too many polygons as large as this")));
}

}  // namespace
}  // namespace palpate::mesh_io
