#include "io/shapes/mesh_archive.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/charconv.h"
#include "core/base/index.h"
#include "core/geometry/half_edges.h"
#include "io/shapes/embedded_shapes.h"

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

/// An entry of the archive.
struct Packed {
  Bytes bytes;
  std::size_t unpacked_size = 0;
};

std::optional<Packed> find_entry(Bytes archive, const std::string& name) {
  for (std::size_t entry = 0; entry < archive.size();) {
    const auto sizes = Columns(archive.subspan(entry)).take<std::uint32_t>(2);  // bytes packed, unpacked
    const std::string_view found(reinterpret_cast<const char*>(&archive[entry + 8]));
    const std::size_t start = entry + 8 + found.size() + 1;
    if (found == name) return Packed{archive.subspan(start, sizes[0]), sizes[1]};
    entry = start + sizes[0];
  }
  return std::nullopt;
}

std::vector<unsigned char> inflate_entry(Bytes archive, const std::string& name) {
  if (const std::optional<Packed> entry = find_entry(archive, name)) {
    std::vector<unsigned char> bytes(entry->unpacked_size);
    if (inflate(entry->bytes, bytes)) return bytes;
  }
  throw std::runtime_error("the archive of built-in shapes has no mesh \"" + name + "\"");
}

TriangleMesh exact_mesh(Columns& columns, std::size_t vertices, std::size_t triangles) {
  TriangleMesh mesh{std::vector<Vec3>(vertices), std::vector<Triangle>(triangles)};
  const auto bits = columns.take<std::uint64_t>(3 * vertices);
  for (std::size_t k = 0; k < bits.size(); ++k) {
    mesh.vertices[k / 3][static_cast<Eigen::Index>(k % 3)] = bit_cast<double>(bits[k]);
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

bool has_mesh(std::span<const unsigned char> archive, const std::string& name) {
  return find_entry(archive, name).has_value();
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
