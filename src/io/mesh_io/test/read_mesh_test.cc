#include "palpate/read_mesh.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_io/test/tetrahedron.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/builtin.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

using palpate::test::TemporaryFolder;

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

template <typename T>
std::string big_endian(T value) {
  std::string bytes = bytes_of(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string binary_stl(const std::vector<std::array<int, 3>>& triangles, const std::string& title = "test") {
  std::string bytes = title;
  bytes.resize(80, ' ');
  bytes += bytes_of(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& triangle : triangles) {
    bytes += std::string(12, '\0');
    for (const int corner : triangle) {
      for (const float x : kVertices[static_cast<std::size_t>(corner)]) bytes += bytes_of(x);
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string ascii_stl() {
  std::string text = "solid test\n";
  for (const auto& triangle : kTriangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : triangle) {
      text += "vertex";
      for (const float x : kVertices[static_cast<std::size_t>(corner)]) text += " " + std::to_string(x);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

const std::string kObj = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const std::string kOff = "OFF\n4 4 6\n0 0 0\n2 0 0\n0 3 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string kPlyHeader =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPly = "ply\nformat ascii 1.0\n" + kPlyHeader +
                         "0 0 0\n2 0 0\n0 3 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

std::string binary_ply(bool is_big) {
  std::string bytes =
      std::string("ply\nformat binary_") + (is_big ? "big" : "little") + "_endian 1.0\n" + kPlyHeader;
  for (const auto& vertex : kVertices) {
    for (const float x : vertex) bytes += is_big ? big_endian(x) : bytes_of(x);
  }
  for (const auto& triangle : kTriangles) {
    bytes += '\3';
    for (const std::int32_t corner : triangle) bytes += is_big ? big_endian(corner) : bytes_of(corner);
  }
  return bytes;
}

std::string chunk(std::uint16_t id, const std::string& content) {
  return bytes_of(id) + bytes_of(static_cast<std::uint32_t>(content.size() + 6)) + content;
}

std::string three_ds() {
  std::string vertices = bytes_of(static_cast<std::uint16_t>(kVertices.size()));
  for (const auto& vertex : kVertices) {
    for (const float x : vertex) vertices += bytes_of(x);
  }
  std::string faces = bytes_of(static_cast<std::uint16_t>(kTriangles.size()));
  for (const auto& triangle : kTriangles) {
    for (const int corner : triangle) faces += bytes_of(static_cast<std::uint16_t>(corner));
    faces += bytes_of(std::uint16_t{7});
  }
  const std::string part =
      std::string("tetra") + '\0' + chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces));
  return chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, part)));
}

std::string gltf_buffer() {
  std::string bytes;
  for (const auto& vertex : kVertices) {
    for (const float x : vertex) bytes += bytes_of(x);
  }
  for (const auto& triangle : kTriangles) {
    for (const int corner : triangle) bytes += bytes_of(static_cast<std::uint16_t>(corner));
  }
  return bytes;  // 48 + 24 bytes
}

std::string gltf_json(const std::string& nodes, const std::string& buffer) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[)" + buffer +
         R"(],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,3,4]},)"
         R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
}

std::string glb(const std::string& nodes) {
  std::string json = gltf_json(nodes, R"({"byteLength":72})");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string body = bytes_of(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
                           bytes_of(std::uint32_t{72}) + std::string("BIN\0", 4) + gltf_buffer();
  return "glTF" + bytes_of(std::uint32_t{2}) + bytes_of(static_cast<std::uint32_t>(12 + body.size())) + body;
}

class ReadMesh : public testing::Test {
 protected:
  LoadedMesh read(const std::string& name, const std::string& bytes,
                  LengthUnit unit = LengthUnit::kMetre) const {
    return read_mesh(folder_.write(name, bytes), unit);
  }

  void expect_tetrahedron(const LoadedMesh& loaded, const Vec3& at = Vec3::Zero()) const {
    EXPECT_EQ(loaded.mesh.vertices.size(), 4U);
    EXPECT_EQ(loaded.mesh.triangles.size(), 4U);
    EXPECT_TRUE(loaded.findings.closed);
    EXPECT_TRUE(loaded.findings.manifold);
    EXPECT_EQ(loaded.findings.shells, 1);
    EXPECT_NEAR(loaded.findings.volume, 4.0, 1e-6);
    EXPECT_THAT(loaded.findings.defects, IsEmpty());
    for (const auto& [x, y, z] : kVertices) {
      const Vec3 want = at + Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
      EXPECT_TRUE(std::any_of(loaded.mesh.vertices.begin(), loaded.mesh.vertices.end(),
                              [&](const Vec3& vertex) { return (vertex - want).norm() < 1e-6; }))
          << want.transpose();
    }
  }

  void expect_refused(const std::string& name, const std::string& bytes, const std::string& words) const {
    EXPECT_THAT(
        [&] { (void)read(name, bytes); },
        ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr(words), testing::Not(HasSubstr("\n")))));
  }

  TemporaryFolder folder_;
};

TEST_F(ReadMesh, BinaryStl) {
  const LoadedMesh loaded = read("a.stl", binary_stl(kTriangles));
  expect_tetrahedron(loaded);
  EXPECT_THAT(loaded.findings.repairs, ElementsAre("joined 12 triangle corners in 4 vertices"));
}
TEST_F(ReadMesh, BinaryStlThatStartsWithSolid) {
  expect_tetrahedron(read("a.stl", binary_stl(kTriangles, "solid x")));
}
TEST_F(ReadMesh, AsciiStl) { expect_tetrahedron(read("a.STL", ascii_stl())); }
TEST_F(ReadMesh, AsciiStlInUpperCaseOrMixedCase) {
  std::string upper = ascii_stl();
  std::string mixed = upper;
  for (std::size_t n = 0; n < upper.size(); ++n) {
    upper[n] = static_cast<char>(std::toupper(upper[n]));
    if (n % 2 == 0) mixed[n] = upper[n];
  }
  expect_tetrahedron(read("a.stl", upper));
  expect_tetrahedron(read("b.stl", mixed));
}
TEST_F(ReadMesh, AsciiStlBehindByteOrderMarkBlanksAndComments) {
  std::string dos = "\xEF\xBB\xBF\n \t# by hand\n// more\n; and more\n  " + ascii_stl();
  for (std::size_t n = dos.find('\n'); n != std::string::npos; n = dos.find('\n', n + 2)) dos.insert(n, "\r");
  expect_tetrahedron(read("a.stl", dos));
  expect_tetrahedron(read("b.stl", "\xEF\xBB\xBF" + ascii_stl()));
}
TEST_F(ReadMesh, StlMessagesDistinguishTextFromBinary) {
  std::string text = ascii_stl();
  text.erase(text.find("vertex"), std::string("vertex").size());
  expect_refused("a.stl", text, "a text STL of 4 facets has 11 vertices: must be three each");
  expect_refused("b.stl", text.substr(text.find('\n') + 1) + std::string(100, ' '),
                 "no STL: a binary one has zero bytes, this has none; a text STL begins with \"solid\"");
  const std::string binary = binary_stl(kTriangles, "solid x");
  expect_refused("c.stl", binary.substr(0, 200), "a binary STL of 4 triangles has 284 bytes, this has 200");
}
TEST_F(ReadMesh, OtherTextFormatsBehindAByteOrderMark) {
  expect_tetrahedron(read("a.obj", "\xEF\xBB\xBF" + kObj));
  expect_tetrahedron(read("a.off", "\xEF\xBB\xBF" + kOff));
  expect_tetrahedron(read("a.ply", "\xEF\xBB\xBF" + kPly));
}
TEST_F(ReadMesh, Obj) {
  const LoadedMesh loaded = read("a.obj", kObj);
  expect_tetrahedron(loaded);
  EXPECT_THAT(loaded.findings.repairs, IsEmpty());
}
TEST_F(ReadMesh, ObjWithNegativeIndicesAndTextureIndices) {
  expect_tetrahedron(
      read("a.obj",
           "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nvt 0 0\nf -4/1 -2/1 -3/1\nf 1/1 2/1 4/1\nf 2/1 "
           "3/1 4/1\nf 1/1 4/1 3/1\n"));
}
TEST_F(ReadMesh, ObjWithAllThatIsNothingToAMesh) {
  const LoadedMesh loaded = read("a.obj",
                                 "mtllib none.mtl\no x\nv 0 0 0 1\nv 2. 0 0 .5 .5 .5\nv 0 +3 0\nv 0 0 "
                                 ".4e1\nvn 0 0 1\nusemtl a b\ng\ns off\n"
                                 "f 1//1 3//99 2//1 # a\nf 1 \\\n2 4\nf 2 3 4\r\nf 1 4 3");
  expect_tetrahedron(loaded);
  EXPECT_THAT(loaded.findings.repairs, IsEmpty());
}
TEST_F(ReadMesh, Off) { expect_tetrahedron(read("a.off", kOff)); }
TEST_F(ReadMesh, OffWithCommentsAndEmptyLines) {
  std::string text = kOff;
  text.insert(4, "# by hand\n\n");
  expect_tetrahedron(read("a.off", text));
}
TEST_F(ReadMesh, AsciiPly) { expect_tetrahedron(read("a.ply", kPly)); }
TEST_F(ReadMesh, BinaryPlyOfEitherByteOrder) {
  expect_tetrahedron(read("a.ply", binary_ply(false)));
  expect_tetrahedron(read("b.ply", binary_ply(true)));
}
TEST_F(ReadMesh, ThreeDsInItsOwnAxes) { expect_tetrahedron(read("a.3ds", three_ds())); }
TEST_F(ReadMesh, BinaryGltf) { expect_tetrahedron(read("a.glb", glb(R"([{"mesh":0}])"))); }
TEST_F(ReadMesh, GltfWithItsBufferBesideIt) {
  (void)folder_.write("a.bin", gltf_buffer());
  expect_tetrahedron(read("a.gltf", gltf_json(R"([{"mesh":0}])", R"({"byteLength":72,"uri":"a.bin"})")));
}

TEST_F(ReadMesh, RefusesAFileOfAnotherKindByWhatItHolds) {
  expect_refused("a.stl", kPly, "is a mesh (PLY): its name must end in .ply");
  expect_refused("u.stl", "\xFF\xFE" + std::string("s\0o\0", 4), "is UTF-16, must be binary or UTF-8");
  expect_refused("b.h5", std::string("\x89HDF\r\n\x1a\n") + std::string(100, '\0'),
                 "is a recording (HDF5), must be a mesh file; palpate view");
  expect_refused("c.stl", std::string("\x89HDF\r\n\x1a\n") + std::string(100, '\0'),
                 "is a recording (HDF5), must be a mesh file");
  expect_refused("d.toml", "[tissue]\nname = \"a\"\n",
                 "is a tissue file, must be a mesh file; --tissue FILE");
}

TEST_F(ReadMesh, NodeTransformsAreApplied) {
  // The child is rotated by 180 degrees about z, then translated by its parent.
  expect_tetrahedron(read("a.glb", glb(R"([{"children":[1],"translation":[10,20,30]},{"mesh":0}])")),
                     {10, 20, 30});
  const LoadedMesh turned =
      read("b.glb", glb(R"([{"children":[1],"translation":[10,0,0]},{"mesh":0,"rotation":[0,0,1,0]}])"));
  EXPECT_LT((geometry::bounds(turned.mesh).low - Vec3(8, -3, 0)).norm(), 1e-5);
  EXPECT_LT((geometry::bounds(turned.mesh).high - Vec3(10, 0, 4)).norm(), 1e-5);
}

TEST_F(ReadMesh, MirroredPartsStayOrientedOutwards) {
  const LoadedMesh loaded = read("a.glb", glb(R"([{"mesh":0,"scale":[-1,1,1]}])"));
  EXPECT_NEAR(loaded.findings.volume, 4.0, 1e-6);
  EXPECT_THAT(loaded.findings.repairs, Contains(HasSubstr("1 mirrored part")));
}

TEST_F(ReadMesh, UnitsBecomeMetres) {
  for (const auto& [unit, metres] : {std::pair{LengthUnit::kMillimetre, 1e-3},
                                     {LengthUnit::kCentimetre, 1e-2},
                                     {LengthUnit::kMetre, 1.0},
                                     {LengthUnit::kInch, 0.0254}}) {
    EXPECT_NEAR(geometry::bounds(read("a.obj", kObj, unit).mesh).high.y(), 3.0 * metres, 1e-15);
  }
}

TEST_F(ReadMesh, AMissingUnitIsAnError) {
  const std::filesystem::path file = folder_.write("a.obj", kObj);
  EXPECT_THAT([&] { (void)read_mesh(file, std::nullopt); },
              ThrowsMessage<InputError>(HasSubstr("unit is missing")));
}

TEST_F(ReadMesh, DuplicateAndUnusedVerticesAreMergedOrDroppedAndReported) {
  const LoadedMesh loaded = read(
      "a.obj",
      "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nv 0 0 -0\nv 2 0 0\nv 9 9 9\nf 1 3 2\nf 5 2 4\nf 6 3 4\nf 1 4 3\n");
  expect_tetrahedron(loaded);
  EXPECT_THAT(loaded.findings.repairs,
              ElementsAre("merged 2 duplicate vertices", "dropped 1 vertex that no triangle uses"));
}

TEST_F(ReadMesh, NearVerticesAreNotMerged) {
  std::string text = kObj;
  text.replace(text.find("f 2 3 4"), 7, "f 5 3 4\nv 2.000001 0 0");
  EXPECT_EQ(read("a.obj", text).mesh.vertices.size(), 5U);
}

TEST_F(ReadMesh, PolygonsAreCutIntoTrianglesAndReported) {
  const LoadedMesh loaded = read("a.obj",
                                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 1\n"
                                 "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
  EXPECT_EQ(loaded.mesh.triangles.size(), 6U);
  EXPECT_TRUE(loaded.findings.closed);
  EXPECT_NEAR(loaded.findings.volume, 1.0 / 3.0, 1e-12);
  EXPECT_THAT(loaded.findings.repairs, ElementsAre("cut 1 polygon into triangles"));
}

TEST_F(ReadMesh, LinesBesideTrianglesAreDroppedAndReported) {
  const LoadedMesh loaded = read("a.obj", kObj + "l 1 2\n");
  expect_tetrahedron(loaded);
  EXPECT_THAT(loaded.findings.repairs, Contains(HasSubstr("dropped 1 line or point")));
}

TEST_F(ReadMesh, AnOpenMeshIsReadAndItsDefectsAreReported) {
  const LoadedMesh loaded =
      read("a.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nv 1 0 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 1 5 2\n");
  EXPECT_FALSE(loaded.findings.closed);
  EXPECT_EQ(loaded.mesh.triangles.size(), 4U);
  EXPECT_THAT(loaded.findings.remarks, Contains("1 triangle without area"));
  EXPECT_THAT(loaded.findings.defects, Contains(HasSubstr("boundary edges")));
}

TEST_F(ReadMesh, RefusesWhatIsNoMeshFile) {
  EXPECT_THAT([&] { (void)read_mesh(folder_.path() / "none.stl", LengthUnit::kMetre); },
              ThrowsMessage<InputError>(HasSubstr("none.stl: there is no such file")));
  EXPECT_THAT([&] { (void)read_mesh(folder_.path(), LengthUnit::kMetre); },
              ThrowsMessage<InputError>(HasSubstr("is a folder, must be a mesh file")));
  expect_refused("a.txt", "solid", "unknown file name extension \".txt\"");
  for (const char* ending : {"stl", "obj", "ply", "off", "3ds", "gltf", "glb"}) {
    expect_refused(std::string("a.") + ending, "", "empty");
    expect_refused(std::string("b.") + ending, "#\n", "b.");
  }
}

TEST_F(ReadMesh, RefusesMeshesWithoutTriangles) {
  expect_refused("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "no triangles (dropped 1 line or point");
  expect_refused("a.stl", binary_stl({}), "no triangles");
  expect_refused("b.stl", "solid x\nendsolid x\n", "no triangles");
}

TEST_F(ReadMesh, RefusesTruncatedFiles) {
  const std::string stl = binary_stl(kTriangles);
  expect_refused("a.stl", stl.substr(0, stl.size() - 1), "4 triangles has 284 bytes, this has 283");
  expect_refused("b.stl", stl.substr(0, 60), "at least 84 bytes");
  const std::string text = ascii_stl();
  expect_refused("c.stl", text.substr(0, text.find("endloop", 200)), "truncated");
  expect_refused("d.stl", text.substr(0, text.find("endsolid")), "no endsolid");
  expect_refused("a.off", kOff.substr(0, kOff.size() - 8), "truncated");
  expect_refused("b.off", kOff.substr(0, kOff.size() - 3), "line 10: truncated: ends in face 4 of 4");
  expect_refused("a.ply", kPly.substr(0, kPly.size() - 3), "ends in face 4 of 4");
  const std::string binary = binary_ply(false);
  expect_refused("b.ply", binary.substr(0, binary.size() - 1), "ends in face 4 of 4");
  expect_refused("c.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "header does not end");
  expect_refused("a.obj", "v 0 0 0\nv 2 0", "line 2: truncated: ends in vertex 2");
  const std::string three = three_ds();
  expect_refused("a.3ds", three.substr(0, three.size() - 1), "truncated");
  const std::string gl = glb(R"([{"mesh":0}])");
  expect_refused("a.glb", gl.substr(0, gl.size() - 1), "truncated");
  const std::string json = gltf_json(R"([{"mesh":0}])", R"({"byteLength":72})");
  expect_refused("a.gltf", json.substr(0, json.size() - 1), "is no JSON");
}

TEST_F(ReadMesh, RefusesNumbersThatAreNotFiniteAndNamesTheVertex) {
  expect_refused("a.obj", "v 0 0 0\nv 2 nan 0\nv 0 3 0\nf 1 2 3\n", "line 2: vertex 2 is not finite");
  expect_refused("b.obj", "v 0 0 0\nv 2 0 0\nv 0 3 1e99\nf 1 2 3\n", "line 3: vertex 3 is not finite");
  expect_refused("c.obj", "v 0 0 0\nv 2 x 0\nv 0 3 1\nf 1 2 3\n", "\"x\" is not a number");
  expect_refused("a.off", "OFF\n3 1 0\n0 0 0\ninf 0 0\n0 3 0\n3 0 1 2\n", "line 4: vertex 2 is not finite");
  std::string ply = kPly;
  ply.replace(ply.find("0 3 0"), 5, "0 nan 0");
  expect_refused("a.ply", ply, "vertex 3 is not finite");
  std::string stl = ascii_stl();
  stl.replace(stl.find("vertex 0.000000"), 15, "vertex nan");
  expect_refused("a.stl", stl, "vertex 1 is not finite");
  std::string binary = binary_stl(kTriangles);
  binary.replace(84 + 50 + 12 + 24, 4, bytes_of(std::nanf("")));  // third corner of the second triangle
  expect_refused("b.stl", binary, "vertex 6 is not finite");
  // nested parts, each scaled by a valid number
  expect_refused("a.glb", glb(R"([{"children":[1],"scale":[1e30,1,1]},{"mesh":0,"scale":[1e30,1,1]}])"),
                 "is not finite (NaN, infinite or past 3.4e38)");
}

TEST_F(ReadMesh, RefusesAVertexIndexOutOfRange) {
  expect_refused("a.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 4\n",
                 "line 4: face 1: vertex index 4 is out of range");
  expect_refused("b.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 0 1 2\n", "vertex index 0 is out of range");
  expect_refused("c.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf -4 1 2\n", "vertex index -4 is out of range");
  expect_refused("d.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf a 1 2\n", "\"a\" is not a vertex index");
  expect_refused("a.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 3 0\n3 0 1 3\n",
                 "line 6: face 1: vertex index 3 is out of range");
  std::string ply = kPly;
  ply.replace(ply.rfind("3 0 3 2"), 7, "3 0 3 4");
  expect_refused("a.ply", ply, "face 4: vertex index 4 is out of range: the file has 4 vertices");
  std::string three = three_ds();
  const std::string face =
      bytes_of(std::uint16_t{1}) + bytes_of(std::uint16_t{2}) + bytes_of(std::uint16_t{3});
  three.replace(three.find(face), 6,
                bytes_of(std::uint16_t{1}) + bytes_of(std::uint16_t{2}) + bytes_of(std::uint16_t{9}));
  expect_refused("a.3ds", three, "cannot be read");
}

TEST_F(ReadMesh, RefusesCountsThatTheFileCannotHold) {
  expect_refused("a.off", "OFF\n353535235358 6 0\n0 0 0\n", "more than its");
  expect_refused("b.off", "OFF\n3 99999999999 0\n0 0 0\n", "more than its");
  expect_refused("c.off", "OFF\n-3 1 0\n0 0 0\n", "\"-3\" is not a number of vertices");
  expect_refused("d.off", "OFF BINARY\n", "save it as text");
  std::string ply = kPly;
  ply.replace(ply.find("vertex 4"), 8, "vertex 999999999");
  expect_refused("a.ply", ply, "declares 999999999 vertex, more than its");
}

TEST_F(ReadMesh, RefusesAPlyInStrips) {
  expect_refused("a.ply", std::string(kPly).replace(kPly.find("face"), 4, "tristrips"), "in element face");
}

TEST_F(ReadMesh, RefusesPolygonsThatWouldTakeTooLong) {
  std::string points;
  std::string corners;
  for (int n = 0; n < 513; ++n) {
    points += std::to_string(n) + " " + std::to_string(n * n) + " 0\n";
    corners += " " + std::to_string(n);
  }
  const std::string words = "a polygon of 513 corners: at most 512 are cut into triangles";
  expect_refused("a.off", "OFF\n513 1 0\n" + points + "513" + corners + "\n", words);
  expect_refused("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 513\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n" +
                     points + "513" + corners + "\n",
                 words);
  const std::string corner = "v 0 0 0\nv 2 0 0\nv 0 3 0\n";
  std::string face = "f";
  for (int n = 0; n < 171; ++n) face += " 1 2 3";
  expect_refused("a.obj", corner + face + "\n", "line 4: face 1: " + words);
  std::string many = corner;
  for (int n = 0; n < 6; ++n)
    many += face.substr(0, face.size() - 2) + "\n";  // 512 corners, 22 million steps
  expect_refused("b.obj", many, "line 9: face 6: too many polygons as large as this one of 512 corners");
}

TEST_F(ReadMesh, RefusesMoreThan32MillionVertices) {
  expect_refused("a.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex 32000001\nproperty uchar x\n"
                 "end_header\n" +
                     std::string(32'000'001, '\0'),
                 "more than 32000000 vertices");
}

TEST_F(ReadMesh, RefusesBadPlyHeaders) {
  expect_refused("a.ply", "plx\n", "must start with \"ply\"");
  expect_refused("b.ply", "ply\nformat binary 1.0\nend_header\n", "must be ascii, binary_little_endian");
  expect_refused("c.ply", "ply\nproperty float x\nend_header\n", "before any element");
  expect_refused("d.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quux x\nend_header\n",
                 "\"quux\" is not a type of numbers");
  expect_refused("e.ply", "ply\nelement vertex 1\nproperty float x\nend_header\n1", "no format");
  expect_refused(
      "twice.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement vertex 1\nproperty float x\n"
      "end_header\n0\n0\n",
      "the header declares element vertex twice");
  std::string many = "ply\nformat ascii 1.0\n";
  for (int n = 0; n < 101; ++n) many += "element e" + std::to_string(n) + " 0\n";
  expect_refused("many.ply", many, "line 103: the header declares more than 100 elements");
  many = "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (int n = 0; n < 1001; ++n) many += "property float x\n";
  expect_refused("wide.ply", many, "line 1004: element vertex has more than 1000 properties");
  expect_refused("noname.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float\nend_header\n0\n",
                 "a property of element vertex has no name");
  expect_refused("nolist.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 1\n"
                 "property list uchar int v\nend_header\n0\n3 0 7 9\n",
                 "element face has no list vertex_indices");
}

TEST_F(ReadMesh, Refuses3dsTracksOfMoreKeysThanTheyHoldBytes) {
  const std::string track = chunk(0xB020, std::string(10, '\0') + "\xff\xff\xff\xff" + std::string(20, '\0'));
  expect_refused("keys.3ds", chunk(0x4D4D, chunk(0xB000, chunk(0xB002, track))),
                 "declares 4294967295 keys in 34 bytes");
  expect_refused("short.3ds", chunk(0x4D4D, chunk(0xB000, chunk(0xB002, chunk(0xB020, "abc")))),
                 "a track of key frames is too short");
  const std::string whole = three_ds();
  const std::string second = chunk(0x4D4D, chunk(0xB000, chunk(0xB002, track)));
  expect_refused("second.3ds", whole + second, "declares 4294967295 keys in 34 bytes");
  const std::string project = chunk(0xC23D, chunk(0xB000, chunk(0xB004, track)));
  expect_refused("project.3ds", whole + project, "declares 4294967295 keys in 34 bytes");
}

TEST_F(ReadMesh, Refuses3dsChunksThatAreLongerThanTheOneAround) {
  const auto declares = [](std::string bytes, std::uint32_t length) {
    return bytes.replace(2, 4, bytes_of(length));
  };
  // A chunk beside it, so that the file does not end with the parent chunk: the importer would read on.
  const std::string beside = chunk(0x3D3D, std::string(64, '\0'));
  const std::string track = chunk(0xB020, std::string(34, '\0'));
  const auto with_track = [&](const std::string& one) {
    return chunk(0x4D4D, chunk(0xB000, chunk(0xB002, one)) + beside);
  };
  expect_refused("track.3ds", with_track(declares(track, 60)),
                 "byte 18: a chunk declares 60 bytes, must be 6 to 40, which are left of the one around it");
  expect_refused("none.3ds", with_track(declares(track, 5)), "byte 18: a chunk declares 5 bytes");
  const std::string node = chunk(0xB002, track);
  expect_refused("node.3ds", chunk(0x4D4D, chunk(0xB000, declares(node, 60)) + beside),
                 "byte 12: a chunk declares 60 bytes, must be 6 to 46");
  const std::string frames = chunk(0xB000, node);
  expect_refused("frames.3ds", chunk(0x4D4D, declares(frames, 60)) + beside,
                 "byte 6: a chunk declares 60 bytes, must be 6 to 52");
  expect_refused("beside.3ds", chunk(0x4D4D, frames) + declares(beside, 71),
                 "byte 58: a chunk declares 71 bytes, must be 6 to 70");
}

TEST_F(ReadMesh, NamesAnotherFormatWhoseLinesAnObjReaderSkips) {
  expect_refused("a.obj",
                 "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                 "endloop\nendfacet\nendsolid\n",
                 ".stl");
}

TEST_F(ReadMesh, RefusesGltfBuffersOutsideItsFolder) {
  for (const std::string uri :
       {"/dev/zero", "../secret.bin", "a/../../b.bin", "file:///etc/passwd", "%2e%2e/b.bin"}) {
    expect_refused("out.gltf",
                   R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri + R"(","byteLength":36}]})",
                   "must be a file in the folder of the mesh");
  }
  const TemporaryFolder outside;
  std::filesystem::create_symlink(outside.write("secret.bin", std::string(36, 's')), folder_ / "linked.bin");
  std::filesystem::create_directory_symlink(outside.path(), folder_ / "linked");
  for (const std::string uri : {"linked.bin", "linked/secret.bin"}) {
    expect_refused("out.gltf",
                   R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri + R"(","byteLength":36}]})",
                   "must be a file in the folder of the mesh");
  }
}

// Each file would take minutes, and the last one 4 GB, if the cost of a line or a node grew with the file's
// size.
TEST_F(ReadMesh, TakesTimeAndMemoryThatGrowWithTheFileAlone) {
  std::string lines;
  for (int n = 0; n < 600'000; ++n) lines += "v 0 0 0\n";
  expect_tetrahedron(read("hash.obj", kObj + lines));
  expect_tetrahedron(read("blank.obj", kObj + std::string(2'000'000, '\n')));
  std::string off = kOff;
  expect_tetrahedron(read("blank.off", off.insert(4, std::string(2'000'000, '\n'))));
  std::string same = R"([{"mesh":0,"children":[0)";
  for (int n = 0; n < 1'000'000; ++n) same += ",0";
  expect_refused("same.gltf", gltf_json(same + "]}]", R"({"byteLength":72})"), "used more than 100000 times");
  std::string none = R"([{"mesh":0,"children":[1)";
  for (int n = 0; n < 90'000; ++n) none += ",1";
  none += R"(]},{"children":[9)";
  for (int n = 0; n < 900'000; ++n) none += ",9";
  expect_refused("none.gltf", gltf_json(none + "]}]", R"({"byteLength":72})"),
                 "node 9 is named but not there");
}

// Positions that collide in a multiplicative hash: its last step, inverted from one value.
TEST_F(ReadMesh, MergesPlacesWhateverTheirBitsHaveInCommon) {
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15U;
  constexpr int kPlaces = 500'000;
  std::string vertices;
  int count = 0;
  for (std::uint64_t n = 0; count < kPlaces; ++n) {
    const std::uint64_t x = 0x3ff0000000000000U;  // 1
    const std::uint64_t y = x + n;
    const std::uint64_t z = ((x * kFactor) ^ y) * kFactor;
    const std::uint64_t exponent = z >> 52U & 0x7ffU;
    if (exponent < 1 || exponent > 1023 + 126) continue;  // not finite, or too large for a mesh
    vertices += bytes_of(x) + bytes_of(y) + bytes_of(z);
    ++count;
  }
  const std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 500000\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
      vertices + '\3' + bytes_of(0) + bytes_of(1) + bytes_of(2);
  EXPECT_THAT(read("a.ply", bytes).findings.repairs,
              ElementsAre("dropped 499997 vertices that no triangle uses"));
}

TEST_F(ReadMesh, ReportsControlCharactersOfAFileAsBlanks) {
  expect_refused("a.vtk", "# vtk DataFile Version 3\1\1.0\na\nASCII\n", "version \"3  .0\"");
}

TEST_F(ReadMesh, RefusesGltfThatWouldTakeTheStackOrTheMemory) {
  expect_refused("a.gltf", std::string(100000, '['), "byte 65 of 100000: is nested deeper than 64 levels");
  std::string doubling = "[";
  for (int n = 1; n <= 40; ++n)
    doubling += R"({"children":[)" + std::to_string(n) + "," + std::to_string(n) + "]},";
  expect_refused("b.glb", glb(doubling + R"({"mesh":0}])"), "used more than");
  expect_refused("c.glb", glb(R"([{"mesh":0,"children":[0]}])"), "nested more than 200 deep");
  std::string sparse = gltf_json(R"([{"mesh":0}])", R"({"byteLength":72})");
  sparse.replace(sparse.find(R"("bufferView":0,"componentType":5126,"count":4)"), 45,
                 R"("componentType":5126,"count":1000000000)");
  expect_refused("d.gltf", sparse, "count 1000000000: must be 1 to 20000000");
  sparse.replace(sparse.find("1000000000"), 10, "1000001,\"sparse\":{}");
  expect_refused("g.gltf", sparse, "1000001 elements without a buffer: must be at most 1000000");
  (void)folder_.write("a.bin", gltf_buffer());
  std::string repeated = gltf_json(R"([{"mesh":0}])", R"({"byteLength":72,"uri":"a.bin"})");
  repeated.replace(repeated.find(R"("count":12)"), 10, R"("count":19999999)");
  std::string values = "[0";
  for (int n = 0; n < 4'000'000; ++n) values += ",0";
  expect_refused("f.gltf", values + "]", "its JSON: has more than 4000000 values");
  expect_refused("e.gltf", repeated, "declare more than 20000000 indices and vertices");
}

}  // namespace
}  // namespace palpate::mesh_io
