#include <cmath>
#include <cstdint>
#include <filesystem>
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
    expect_refused("a.gltf", json.replace(json.find(from), from.size(), to),
                   "accessor 0 of quantized positions: " + words);
  };
  const std::string json = quantized_json(5121, false, 4, 1.0, R"("uri":"a.bin",)");
  refuses(json, R"("count":4)", R"("count":5)", "5 vertices do not fit in its 16 bytes");
  refuses(json, R"("count":4)", R"("count":6000000)", "count 6000000: must be 1 to 5000000");
  refuses(json, R"("byteStride":4)", R"("byteStride":2)", "4 vertices do not fit");
  refuses(json, R"("bufferView":0,)", "", "has no bufferView");
  refuses(json, R"(5121)", "5125", "componentType 5125: must be 5120, 5121, 5122, 5123 or 5126");
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

}  // namespace
}  // namespace palpate::mesh_io
