#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/text.h"
#include "io/mesh_io/test/tetrahedron.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string corners_of_tetrahedron() {
  std::string bytes;
  for (const auto& triangle : kTriangles) {
    for (const int corner : triangle) bytes += bytes_of(static_cast<std::uint16_t>(corner));
  }
  return bytes;  // 24
}

class Gltf : public testing::Test {
 protected:
  LoadedMesh read(const std::string& name, const std::string& bytes) const {
    return read_mesh(folder_.write(name, bytes), LengthUnit::kMetre);
  }

  void expect_refused(const std::string& name, const std::string& bytes, const std::string& words) const {
    EXPECT_THAT([&] { (void)read(name, bytes); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr(words))));
  }

  palpate::test::TemporaryFolder folder_;
};

/// The tetrahedron's positions as whole numbers, `unit` to a length of 1, each padded to `stride` bytes.
template <typename T>
std::string quantized_positions(double unit, std::size_t stride) {
  std::string bytes;
  for (const auto& vertex : kVertices) {
    std::string one;
    for (const float x : vertex) one += bytes_of(static_cast<T>(unit * static_cast<double>(x)));
    one.resize(stride, '?');
    bytes += one;
  }
  return bytes;
}

/// @param scale of the node that makes the numbers lengths again
std::string quantized_json(int type, bool normalized, std::size_t stride, double scale,
                           const std::string& buffer_key) {
  const std::string positions = std::to_string(4 * stride);
  return R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_mesh_quantization"],)"
         R"("extensionsRequired":["KHR_mesh_quantization"],"scene":0,"scenes":[{"nodes":[0]}],)"
         R"("nodes":[{"mesh":0,"translation":[10,20,30],"scale":[)" +
         shortest(scale) + "," + shortest(scale) + "," + shortest(scale) +
         R"(]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1}]}],)"
         R"("buffers":[{)" +
         buffer_key + R"("byteLength":)" + std::to_string(4 * stride + 24) +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + positions + R"(,"byteStride":)" +
         std::to_string(stride) + R"(},{"buffer":0,"byteOffset":)" + positions +
         R"(,"byteLength":24}],"accessors":[{"bufferView":0,"componentType":)" + std::to_string(type) +
         (normalized ? R"(,"normalized":true)" : "") +
         R"(,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
}

struct Quantized {
  int type;
  bool normalized;
  std::size_t stride;
  double scale;
  std::string positions;
};

std::vector<Quantized> quantized_forms() {
  return {{5120, false, 4, 1.0 / 30, quantized_positions<std::int8_t>(30, 4)},
          {5120, true, 4, 127.0 / 30, quantized_positions<std::int8_t>(30, 4)},
          {5121, false, 4, 1.0 / 60, quantized_positions<std::uint8_t>(60, 4)},
          {5121, true, 4, 255.0 / 60, quantized_positions<std::uint8_t>(60, 4)},
          {5122, false, 8, 1.0 / -8000, quantized_positions<std::int16_t>(-8000, 8)},
          {5122, true, 8, 32767.0 / 8000, quantized_positions<std::int16_t>(8000, 8)},
          {5123, false, 8, 1.0 / 16000, quantized_positions<std::uint16_t>(16000, 8)},
          {5123, true, 6, 65535.0 / 16000, quantized_positions<std::uint16_t>(16000, 6)}};
}

TEST_F(Gltf, ReadsQuantizedPositionsOfEveryType) {
  const std::string corners = corners_of_tetrahedron();
  for (const Quantized& form : quantized_forms()) {
    SCOPED_TRACE(form.type);
    (void)folder_.write("a.bin", form.positions + corners);
    const LoadedMesh beside = read(
        "a.gltf", quantized_json(form.type, form.normalized, form.stride, form.scale, R"("uri":"a.bin",)"));
    EXPECT_NEAR(std::abs(beside.findings.volume), 4.0, 1e-3);
    const geometry::Bounds box = geometry::bounds(beside.mesh);
    EXPECT_LT((box.low - Vec3(10, 20, 30)).norm(), 1e-3);
    EXPECT_LT((box.high - Vec3(12, 23, 34)).norm(), 1e-3);
    std::string json = quantized_json(form.type, form.normalized, form.stride, form.scale, "");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string binary = form.positions + corners;
    const std::string body = bytes_of(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
                             bytes_of(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) +
                             binary;
    const LoadedMesh packed =
        read("a.glb", "glTF" + bytes_of(std::uint32_t{2}) +
                          bytes_of(static_cast<std::uint32_t>(12 + body.size())) + body);
    EXPECT_EQ(packed.mesh.vertices, beside.mesh.vertices);
    EXPECT_EQ(packed.mesh.triangles, beside.mesh.triangles);
  }
}

TEST_F(Gltf, ReadsQuantizedPositionsInADataUri) {
  // 0 0 0, 2 0 0, 0 3 0, 0 0 4 as bytes with one of padding, then corners_of_tetrahedron().
  const std::string uri =
      R"("uri":"data:application/octet-stream;base64,AAAAAAIAAAAAAwAAAAAEAAAAAgABAAAAAQADAAEAAgADAAAAAwACAA==",)";
  const LoadedMesh loaded = read("a.gltf", quantized_json(5121, false, 4, 1.0, uri));
  EXPECT_NEAR(loaded.findings.volume, 4.0, 1e-6);
  EXPECT_EQ(bounds(loaded.mesh).low, Vec3(10, 20, 30));
  EXPECT_EQ(bounds(loaded.mesh).high, Vec3(12, 23, 34));
}

TEST_F(Gltf, RefusesQuantizedPositionsThatTheBufferDoesNotHold) {
  (void)folder_.write("a.bin", std::string(40, '\0'));
  const auto refuses = [&](std::string json, const std::string& from, const std::string& to,
                           const std::string& words) {
    expect_refused("a.gltf", json.replace(json.find(from), from.size(), to), "accessor 0: " + words);
  };
  const std::string json = quantized_json(5121, false, 4, 1.0, R"("uri":"a.bin",)");
  refuses(json, R"("count":4)", R"("count":5)", "5 elements do not fit in its 16 bytes");
  refuses(json, R"("count":4)", R"("count":60000000)", "count 60000000: must be 1 to 20000000");
  refuses(json, R"("byteStride":4)", R"("byteStride":2)", "4 elements do not fit");
  refuses(json, R"("bufferView":0,)", "", "has no bufferView");
  refuses(json, R"(5121)", "5124", "componentType 5124: must be 5120, 5121, 5122, 5123, 5125 or 5126");
  refuses(json, R"(VEC3)", "VEC2", "its type must be VEC3");
  refuses(json, R"("byteLength":16)", R"("byteLength":60)", "its buffer is truncated: has 40 bytes");
}

TEST_F(Gltf, RefusesBuffersThatExceedAMeshFilesLargestSizeTogether) {
  std::filesystem::resize_file(folder_.write("a.bin", ""), std::uintmax_t{300} << 20U);
  std::string json = quantized_json(5121, false, 4, 1.0, R"("uri":"a.bin",)");
  const std::string buffers = R"("buffers":[)";
  json.insert(json.find(buffers) + buffers.size(), R"({"uri":"a.bin","byteLength":40},)");
  expect_refused("a.gltf", json, "buffer \"a.bin\": its buffers have more than 512 MiB in all");
}

TEST_F(Gltf, RefusesExtensionsByNameThatChangeItsVertices) {
  (void)folder_.write("a.bin", quantized_positions<std::uint8_t>(1, 4) + corners_of_tetrahedron());
  const std::string json = quantized_json(5121, false, 4, 1.0, R"("uri":"a.bin",)");
  const auto with = [&](const std::string& before, const std::string& added) {
    std::string made = json;
    return made.insert(made.find(before) + before.size(), added);
  };
  const std::string required = R"("extensionsRequired":[)";
  expect_refused("a.gltf", with(required, R"("KHR_draco_mesh_compression",)"),
                 "compressed by Draco (KHR_draco_mesh_compression), which is not read: export it without");
  expect_refused("b.gltf", with(required, R"("EXT_meshopt_compression",)"),
                 "compressed by meshopt (EXT_meshopt_compression), which is not read");
  expect_refused("c.gltf", with(required, R"("KHR_materials_unlit","ABC_warp",)"),
                 "needs the glTF extension ABC_warp, which is not read");
  expect_refused("d.gltf", with(R"("mesh":0,)", R"("extensions":{"EXT_mesh_gpu_instancing":{}},)"),
                 "needs the glTF extension EXT_mesh_gpu_instancing");
  EXPECT_NEAR(read("e.gltf", with(required, R"("KHR_materials_unlit",)")).findings.volume, 4.0, 1e-6);
}

TEST_F(Gltf, RefusesCompressedMeshesWhoseExtensionIsOnlyUsed) {
  (void)folder_.write("a.bin", quantized_positions<std::uint8_t>(1, 4) + corners_of_tetrahedron());
  std::string draco = quantized_json(5121, false, 4, 1.0, R"("uri":"a.bin",)");
  draco.erase(draco.find(R"("bufferView":0,"componentType")"), std::string(R"("bufferView":0,)").size());
  const std::string part = R"("indices":1)";
  draco.insert(draco.find(part), R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":0}},)");
  expect_refused("a.gltf", draco, "compressed by Draco");
  expect_refused(
      "b.gltf",
      quantized_json(5121, false, 4, 1.0, R"("extensions":{"EXT_meshopt_compression":{"fallback":true}},)"),
      "compressed by meshopt");
}

/// The tetrahedron's positions and corners in one buffer with further numbers behind them.
struct Rigged {
  std::string buffer;  // positions 0 to 47, corners 48 to 71
  std::string views = R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24})";
  std::string accessors = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                          R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"})";
  int count = 2;  // of views and accessors

  Rigged() {
    for (const auto& vertex : kVertices)
      for (const float x : vertex) buffer += bytes_of(x);
    buffer += corners_of_tetrahedron();
  }
  /// @return the index of a new accessor
  int add(const std::string& bytes, int type, int elements, const std::string& shape) {
    views += R"(,{"buffer":0,"byteOffset":)" + std::to_string(buffer.size()) + R"(,"byteLength":)" +
             std::to_string(bytes.size()) + "}";
    accessors += R"(,{"bufferView":)" + std::to_string(count) + R"(,"componentType":)" +
                 std::to_string(type) + R"(,"count":)" + std::to_string(elements) + R"(,"type":")" + shape +
                 "\"}";
    buffer += bytes;
    return count++;
  }
  /// @param part keys of the primitive besides POSITION's attribute and the indices @param rest of the file
  [[nodiscard]] std::string json(const std::string& attributes, const std::string& part,
                                 const std::string& rest) const {
    return R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0)" + attributes +
           R"(},"indices":1)" + part + R"(}]}],"buffers":[{"uri":"a.bin","byteLength":)" +
           std::to_string(buffer.size()) + R"(}],"bufferViews":[)" + views + R"(],"accessors":[)" +
           accessors + "]," + rest + "}";
  }
};

std::string floats(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes += bytes_of(value);
  return bytes;
}

// Joint 1 stands 100 above joint 0 and moves only the vertex (0, 0, 4), by half.
TEST_F(Gltf, PosesASkinnedMeshByItsJoints) {
  Rigged rigged;
  const int which = rigged.add(std::string("\0\1\0\0\0\1\0\0\0\1\0\0\0\1\0\0", 16), 5121, 4, "VEC4");
  const int weight =
      rigged.add(floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0}), 5126, 4, "VEC4");
  (void)folder_.write("a.bin", rigged.buffer);
  const std::string attributes =
      R"(,"JOINTS_0":)" + std::to_string(which) + R"(,"WEIGHTS_0":)" + std::to_string(weight);
  // The node's own transform does not count. Without inverse bind matrices, a joint's transform is its own.
  const std::string nodes =
      R"("scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0,"translation":[500,0,0]},)"
      R"({"children":[2],"translation":[10,0,0]},{"translation":[0,0,100]}],"skins":[{"joints":[1,2]}])";
  const geometry::Bounds box = geometry::bounds(read("a.gltf", rigged.json(attributes, "", nodes)).mesh);
  EXPECT_LT((box.low - Vec3(10, 0, 0)).norm(), 1e-9);
  EXPECT_LT((box.high - Vec3(12, 3, 54)).norm(), 1e-9);  // 4 + 100 / 2
}

TEST_F(Gltf, PosesAJointByItsInverseBindMatrix) {
  Rigged rigged;
  const int which = rigged.add(std::string(16, '\0'), 5121, 4, "VEC4");
  const int weight = rigged.add(floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), 5126, 4, "VEC4");
  const int bind = rigged.add(floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -10, 0, 0, 1}), 5126, 1, "MAT4");
  (void)folder_.write("a.bin", rigged.buffer);
  const std::string attributes =
      R"(,"JOINTS_0":)" + std::to_string(which) + R"(,"WEIGHTS_0":)" + std::to_string(weight);
  const std::string nodes =
      R"("scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{"translation":[10,0,0],"scale":[2,2,2]}],)"
      R"("skins":[{"joints":[1],"inverseBindMatrices":)" +
      std::to_string(bind) + "}]";
  // Joint times bind: 2 (p - 10) + 10.
  const geometry::Bounds box = geometry::bounds(read("a.gltf", rigged.json(attributes, "", nodes)).mesh);
  EXPECT_LT((box.low - Vec3(-10, 0, 0)).norm(), 1e-9);
  EXPECT_LT((box.high - Vec3(-6, 6, 8)).norm(), 1e-9);
}

TEST_F(Gltf, RefusesASkinWhoseJointsAreNotThere) {
  Rigged rigged;
  const int which = rigged.add(std::string(16, '\3'), 5121, 4, "VEC4");
  const int weight = rigged.add(floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), 5126, 4, "VEC4");
  (void)folder_.write("a.bin", rigged.buffer);
  const std::string attributes =
      R"(,"JOINTS_0":)" + std::to_string(which) + R"(,"WEIGHTS_0":)" + std::to_string(weight);
  const auto nodes = [](const std::string& skin) {
    return R"("scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{}],"skins":[)" + skin + "]";
  };
  expect_refused("a.gltf", rigged.json(attributes, "", nodes(R"({"joints":[1]})")),
                 "joint 3 is out of range: the skin has 1");
  Rigged below;
  const int minus = below.add(std::string(16, '\xFF'), 5120, 4, "VEC4");
  below.add(floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), 5126, 4, "VEC4");
  (void)folder_.write("a.bin", below.buffer);
  expect_refused("e.gltf",
                 below.json(R"(,"JOINTS_0":)" + std::to_string(minus) + R"(,"WEIGHTS_0":3)", "",
                            nodes(R"({"joints":[1]})")),
                 "joint -1 is out of range: the skin has 1");
  (void)folder_.write("a.bin", rigged.buffer);
  expect_refused("b.gltf", rigged.json(attributes, "", nodes(R"({"joints":[7]})")),
                 "skin 0: joint 0 is no node of the scene");
  expect_refused("c.gltf", rigged.json(attributes, "", nodes("")), "skin 0 is named but not there: it has 0");
  expect_refused("d.gltf", rigged.json("", "", nodes(R"({"joints":[1,1]})")),
                 "must have JOINTS_0 and WEIGHTS_0");
}

TEST_F(Gltf, MovesVerticesByTheWeightsOfMorphTargets) {
  Rigged rigged;
  const int moved = rigged.add(floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8}), 5126, 4, "VEC3");
  (void)folder_.write("a.bin", rigged.buffer);
  const std::string targets = R"(,"targets":[{"POSITION":)" + std::to_string(moved) + "}]";
  const auto height = [&](const std::string& name, const std::string& node) {
    return geometry::bounds(read(name, rigged.json("", targets, R"("nodes":[{"mesh":0)" + node + "}]")).mesh)
        .high.z();
  };
  EXPECT_NEAR(height("a.gltf", ""), 4.0, 1e-9);
  EXPECT_NEAR(height("b.gltf", R"(,"weights":[0])"), 4.0, 1e-9);
  EXPECT_NEAR(height("c.gltf", R"(,"weights":[0.25])"), 6.0, 1e-9);
}

TEST_F(Gltf, ReadsSparsePositions) {
  Rigged rigged;
  rigged.add(std::string("\3\0\0\0", 4), 5123, 1, "SCALAR");  // bufferView 2: the vertex (0, 0, 4)
  rigged.add(floats({0, 0, 7}), 5126, 1, "VEC3");             // bufferView 3
  (void)folder_.write("a.bin", rigged.buffer);
  std::string json = rigged.json("", "", R"("nodes":[{"mesh":0}])");
  const std::string first = R"("count":4,"type":"VEC3")";
  json.insert(
      json.find(first) + first.size(),
      R"(,"sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}})");
  EXPECT_NEAR(geometry::bounds(read("a.gltf", json).mesh).high.z(), 7.0, 1e-9);
  json.replace(json.find(R"("count":1,"indices")"), 9, R"("count":9)");
  expect_refused("b.gltf", json, "accessor 0: its sparse values must have a count of 1 to its own");
}

TEST_F(Gltf, ReadsStripsAndFans) {
  Rigged rigged;
  // The tetrahedron as one strip of four triangles around it: 0 1 2 3 0 1.
  std::string strip;
  for (const int corner : {0, 2, 1, 3, 0, 2}) strip += bytes_of(static_cast<std::uint16_t>(corner));
  const int strip_at = rigged.add(strip, 5123, 6, "SCALAR");
  // Its three sides around the corner 3 as a fan, and its floor as triangles.
  std::string fan;
  for (const int corner : {3, 0, 1, 2, 0}) fan += bytes_of(static_cast<std::uint16_t>(corner));
  const int fan_at = rigged.add(fan, 5123, 5, "SCALAR");
  std::string floor;
  for (const int corner : {0, 2, 1}) floor += bytes_of(static_cast<std::uint16_t>(corner));
  const int floor_at = rigged.add(floor, 5123, 3, "SCALAR");
  (void)folder_.write("a.bin", rigged.buffer);
  const auto part = [](int indices, int mode) {
    return R"({"attributes":{"POSITION":0},"indices":)" + std::to_string(indices) + R"(,"mode":)" +
           std::to_string(mode) + "}";
  };
  const auto with_parts = [&](const std::string& parts) {
    std::string json = rigged.json("", "", R"("nodes":[{"mesh":0}])");
    const std::size_t begin = json.find(R"("primitives":[)") + 14;
    return json.replace(begin, json.find("}]}]") + 1 - begin, parts);
  };
  const LoadedMesh as_strip = read("a.gltf", with_parts(part(strip_at, 5)));
  EXPECT_NEAR(as_strip.findings.volume, 4.0, 1e-9);
  EXPECT_TRUE(as_strip.findings.closed);
  const LoadedMesh as_fan = read("b.gltf", with_parts(part(fan_at, 6) + "," + part(floor_at, 4)));
  EXPECT_NEAR(as_fan.findings.volume, 4.0, 1e-9);
  expect_refused("c.gltf", with_parts(part(fan_at, 4)), "5 indices make no triangles");
  expect_refused("d.gltf", with_parts(part(fan_at, 9)), "mode 9: must be 0 to 6");
}

TEST_F(Gltf, TakesTheSceneThatTheFileNames) {
  Rigged rigged;
  (void)folder_.write("a.bin", rigged.buffer);
  const std::string nodes = R"("nodes":[{"mesh":0},{"mesh":0,"scale":[3,1,1]}])";
  const auto width = [&](const std::string& name, const std::string& scenes) {
    return geometry::bounds(read(name, rigged.json("", "", scenes + nodes)).mesh).high.x();
  };
  EXPECT_NEAR(width("a.gltf", R"("scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1,)"), 6.0, 1e-9);
  EXPECT_NEAR(width("b.gltf", R"("scenes":[{"nodes":[0]},{"nodes":[1]}],)"), 2.0, 1e-9);
  EXPECT_NEAR(width("c.gltf", ""), 6.0, 1e-9) << "without a scene: all nodes";
  expect_refused("d.gltf", rigged.json("", "", R"("scenes":[{"nodes":[0]}],"scene":4,)" + nodes),
                 "scene 4 is named but not there: it has 1");
}

TEST_F(Gltf, OpensABufferWhoseNameIsPercentEncoded) {
  Rigged rigged;
  (void)folder_.write("my organ.bin", rigged.buffer);
  std::string json = rigged.json("", "", R"("nodes":[{"mesh":0}])");
  json.replace(json.find("a.bin"), 5, "my%20organ.bin");
  EXPECT_NEAR(read("a.gltf", json).findings.volume, 4.0, 1e-9);
}

TEST_F(Gltf, NamesItselfAndABufferThatIsNotThere) {
  Rigged rigged;
  std::string json = rigged.json("", "", R"("nodes":[{"mesh":0}])");
  json.replace(json.find("a.bin"), 5, "b%0Ac.bin");
  expect_refused("a.gltf", json, R"(a.gltf: buffer "b%0Ac.bin": )");
}

TEST_F(Gltf, RefusesASkinThatTakesTimeBeyondTheFile) {
  std::string uses = "0";
  for (int i = 0; i < 3000; ++i) uses += ",0";
  std::string joints = "0";
  for (int i = 0; i < 10'000; ++i) joints += ",0";
  expect_refused("a.gltf",
                 R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[]}],"scenes":[{"nodes":[)" + uses +
                     R"(]}],"nodes":[{"mesh":0,"skin":0}],"skins":[{"joints":[)" + joints + "]}]}",
                 "declare more than 20000000 indices and vertices");
}

TEST_F(Gltf, RefusesOtherVersionsAndTransformsThatAreNone) {
  Rigged rigged;
  (void)folder_.write("a.bin", rigged.buffer);
  std::string old = rigged.json("", "", R"("nodes":[{"mesh":0}])");
  old.replace(old.find("2.0"), 3, "1.0");
  expect_refused("a.gltf", old, "is glTF 1.0, must be 2.0");
  const auto node = [&](const std::string& keys) {
    return rigged.json("", "", R"("nodes":[{"mesh":0,)" + keys + "}]");
  };
  expect_refused("b.gltf", node(R"("rotation":[0,0,2,0])"), "node 0: rotation has the length 2, must be 1");
  expect_refused("c.gltf", node(R"("translation":[0,0])"), "node 0: translation must be 3 numbers");
  expect_refused("d.gltf", node(R"("matrix":["1"])"), "node 0: matrix must be 16 numbers");
}

}  // namespace
}  // namespace palpate::mesh_io
