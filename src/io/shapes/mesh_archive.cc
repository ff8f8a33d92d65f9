#include "io/shapes/mesh_archive.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <zlib.h>

#include "core/base/index.h"
#include "core/geometry/edge_key.h"

// The assembler embeds the archive in the object file.
asm(R"(
  .pushsection .rodata
palpate_shapes: .incbin ")" PALPATE_SHAPES R"("
palpate_shapes_end:
  .popsection
)");
extern "C" {
[[gnu::visibility("hidden")]] extern const unsigned char palpate_shapes[];
[[gnu::visibility("hidden")]] extern const unsigned char palpate_shapes_end[];
}

namespace palpate::geometry {

namespace {

using Bytes = std::span<const unsigned char>;

class Columns final {
 public:
  explicit Columns(Bytes bytes) : bytes_(bytes) {}

  template <typename Number>
  std::vector<Number> take(std::size_t count) {
    std::vector<Number> numbers(count, 0);
    for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
      for (Number& number : numbers) number |= static_cast<Number>(bytes_[next_++]) << (8 * byte);
    }
    return numbers;
  }
  std::vector<std::int32_t> take_signed(std::size_t count) {
    std::vector<std::int32_t> numbers;
    for (const std::uint32_t n : take<std::uint32_t>(count)) {
      numbers.push_back(static_cast<std::int32_t>((n >> 1U) ^ (0U - (n & 1U))));
    }
    return numbers;
  }

 private:
  Bytes bytes_;
  std::size_t next_ = 0;
};

std::vector<unsigned char> inflate_entry(Bytes archive, const std::string& name) {
  for (std::size_t entry = 0; entry < archive.size();) {
    const auto sizes = Columns(archive.subspan(entry)).take<std::uint32_t>(2);  // bytes packed, unpacked
    const std::string_view found(reinterpret_cast<const char*>(&archive[entry + 8]));
    const std::size_t start = entry + 8 + found.size() + 1;
    if (found == name) {
      std::vector<unsigned char> bytes(sizes[1]);
      uLongf size = bytes.size();
      if (uncompress(bytes.data(), &size, &archive[start], sizes[0]) == Z_OK) return bytes;
    }
    entry = start + sizes[0];
  }
  throw std::runtime_error("the archive of built-in shapes has no mesh \"" + name + "\"");
}

TriangleMesh exact_mesh(Columns& columns, std::size_t vertices, std::size_t triangles) {
  TriangleMesh mesh{std::vector<Vec3>(vertices), std::vector<Triangle>(triangles)};
  const auto bits = columns.take<std::uint64_t>(3 * vertices);
  for (std::size_t k = 0; k < bits.size(); ++k) {
    mesh.vertices[k / 3][static_cast<Eigen::Index>(k % 3)] = std::bit_cast<double>(bits[k]);
  }
  const auto steps = columns.take_signed(3 * triangles);
  std::int32_t corner = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) mesh.triangles[k / 3][k % 3] = corner += steps[k];
  return mesh;
}

TriangleMesh grown_mesh(Columns& columns, std::size_t vertices, std::size_t triangles, double spacing) {
  TriangleMesh mesh;
  const auto steps = columns.take_signed(3 * vertices);
  const auto add_vertex = [&](const Vec3& expected) {
    const std::size_t k = 3 * mesh.vertices.size();
    mesh.vertices.emplace_back(expected + spacing * Vec3(steps[k], steps[k + 1], steps[k + 2]));
  };
  std::unordered_map<std::uint64_t, std::int32_t>
      third_of;  // edge -> third corner of its triangle; -1: both triangles exist
  std::vector<std::array<std::int32_t, 2>> edges;  // with the direction of the missing triangle
  const auto add_triangle = [&](const Triangle& corners) {
    mesh.triangles.push_back(corners);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = corners[k];
      const std::int32_t b = corners[(k + 1) % 3];
      const auto [entry, is_new] = third_of.try_emplace(edge_key(a, b), corners[(k + 2) % 3]);
      if (!is_new) entry->second = -1;
      edges.push_back({b, a});
    }
  };
  for (int k = 0; k < 3; ++k) add_vertex(Vec3::Zero());
  add_triangle({0, 1, 2});
  const auto thirds = columns.take<std::uint32_t>(triangles - 1);
  for (std::size_t next = 0; mesh.triangles.size() < triangles; ++next) {
    const auto [a, b] = edges[next];
    const std::int32_t across = third_of.at(edge_key(a, b));
    if (across < 0) continue;
    const std::uint32_t back = thirds[mesh.triangles.size() - 1];
    const auto third = static_cast<std::int32_t>(mesh.vertices.size() - back);
    if (back == 0) add_vertex(mesh.vertices[at(a)] + mesh.vertices[at(b)] - mesh.vertices[at(across)]);
    add_triangle({a, b, third});
  }
  return mesh;
}

}  // namespace

std::span<const unsigned char> built_in_meshes() noexcept {
  return {static_cast<const unsigned char*>(palpate_shapes),
          static_cast<const unsigned char*>(palpate_shapes_end)};
}

TriangleMesh unpack_mesh(std::span<const unsigned char> archive, const std::string& name) {
  const std::vector<unsigned char> bytes = inflate_entry(archive, name);
  Columns columns(bytes);
  const auto head = columns.take<std::uint32_t>(4);
  if (head[2] == 0) return exact_mesh(columns, head[0], head[1]);
  TriangleMesh mesh = grown_mesh(columns, head[0], head[1], std::ldexp(1.0, -static_cast<int>(head[2])));
  for (std::uint32_t k = 0; k < head[3]; ++k) mesh = subdivide(mesh);
  return mesh;
}

}  // namespace palpate::geometry
