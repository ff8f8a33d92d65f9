#include "tools/make_shapes/pack_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <fmt/core.h>
#include <zlib.h>

#include "core/base/index.h"
#include "io/shapes/mesh_archive.h"
#include "palpate/error.h"

namespace palpate::geometry {

namespace {

class ColumnWriter final {
 public:
  template <typename Number>
  void put(const std::vector<Number>& numbers) {
    for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
      for (const Number number : numbers) bytes_.push_back(static_cast<char>(number >> (8 * byte) & 0xffU));
    }
  }
  void put_signed(const std::vector<std::int64_t>& numbers) {
    std::vector<std::uint32_t> coded;
    for (const std::int64_t n : numbers) {
      if (n != static_cast<std::int32_t>(n)) throw InputError(fmt::format("pack_mesh: {} is too large", n));
      coded.push_back(static_cast<std::uint32_t>(n) << 1U ^ (n < 0 ? ~0U : 0U));
    }
    put(coded);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

void put_exact(const TriangleMesh& mesh, ColumnWriter& writer) {
  std::vector<std::uint64_t> bits;
  for (const Vec3& v : mesh.vertices) {
    for (const double coordinate : v) bits.push_back(std::bit_cast<std::uint64_t>(coordinate));
  }
  writer.put(bits);
  std::vector<std::int64_t> steps;
  std::int32_t before = 0;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::int32_t corner : triangle) {
      steps.push_back(corner - before);
      before = corner;
    }
  }
  writer.put_signed(steps);
}

/// Visits the triangles in the order in which the reader adds them.
class Traversal final {
 public:
  Traversal(const TriangleMesh& mesh, int grid) : numbers_(mesh.vertices.size(), -1) {
    for (const Vec3& v : mesh.vertices) {
      const Vec3 steps = v * std::ldexp(1.0, grid);
      places_.push_back({std::llround(steps.x()), std::llround(steps.y()), std::llround(steps.z())});
    }
    for (const Triangle& corners : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k)
        third_[key(corners[k], corners[(k + 1) % 3])] = corners[(k + 2) % 3];
    }
    for (const std::int32_t corner : mesh.triangles.front()) add_vertex(corner, {0, 0, 0});
    add_triangle(mesh.triangles.front());
    for (std::size_t k = 0; k < open_.size(); ++k) cross(open_[k]);
  }

  void put(ColumnWriter& writer) const {
    writer.put_signed(residuals_);
    writer.put(thirds_);
  }
  /// The number of each vertex in the archive; -1: not reached.
  [[nodiscard]] const std::vector<std::int32_t>& numbers() const { return numbers_; }

 private:
  using Place = std::array<std::int64_t, 3>;
  using Edge = std::array<std::int32_t, 2>;
  static std::uint64_t key(std::int32_t a, std::int32_t b) { return std::uint64_t{at(a)} << 32U | at(b); }

  void cross(const Edge& edge) {
    const auto [a, b] = edge;
    if (done_.contains(key(a, b))) return;
    const std::int32_t c = third_.at(key(a, b));
    thirds_.push_back(numbers_[at(c)] < 0 ? 0U : static_cast<std::uint32_t>(count_ - numbers_[at(c)]));
    if (numbers_[at(c)] < 0) {
      const std::int32_t across = third_.at(key(b, a));
      Place expected{};
      for (std::size_t k = 0; k < 3; ++k) {
        expected[k] = places_[at(a)][k] + places_[at(b)][k] - places_[at(across)][k];
      }
      add_vertex(c, expected);
    }
    add_triangle({a, b, c});
  }
  void add_vertex(std::int32_t v, const Place& expected) {
    numbers_[at(v)] = count_++;
    for (std::size_t k = 0; k < 3; ++k) residuals_.push_back(places_[at(v)][k] - expected[k]);
  }
  void add_triangle(const Triangle& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      done_.insert(key(corners[k], corners[(k + 1) % 3]));
      open_.push_back({corners[(k + 1) % 3], corners[k]});
    }
  }

  std::vector<Place> places_;                              // of the mesh's vertices [steps of the grid]
  std::vector<std::int32_t> numbers_;                      // of the mesh's vertices in the archive
  std::unordered_map<std::uint64_t, std::int32_t> third_;  // directed edge -> third corner of its triangle
  std::unordered_set<std::uint64_t> done_;                 // directed edges of the visited triangles
  std::vector<Edge> open_;                                 // with the direction of the missing triangle
  std::int32_t count_ = 0;
  std::vector<std::int64_t> residuals_;
  std::vector<std::uint32_t> thirds_;
};

void append_entry(std::string& archive, const std::string& name, const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<Bytef> packed(size);
  const auto* const from = reinterpret_cast<const Bytef*>(bytes.data());
  if (compress2(packed.data(), &size, from, bytes.size(), Z_BEST_COMPRESSION) != Z_OK) {
    throw InputError("pack_mesh: zlib does not compress " + name);
  }
  ColumnWriter sizes;
  sizes.put(std::vector{static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(bytes.size())});
  archive += sizes.bytes() + name + '\0';
  archive.append(reinterpret_cast<const char*>(packed.data()), size);
}

/// Reads the last entry and compares it with the mesh.
void check(const std::string& archive, const std::string& name, const TriangleMesh& mesh,
           const Packing& packing, const std::vector<std::int32_t>& numbers) {
  const std::span bytes(reinterpret_cast<const unsigned char*>(archive.data()), archive.size());
  const TriangleMesh back = unpack_mesh(bytes, name);
  bool same = back.triangles.size() == mesh.triangles.size() << (2 * packing.divisions);
  if (packing.grid == 0) {
    same = back.triangles == mesh.triangles && back.vertices == mesh.vertices;
  } else {
    const double most = 0.501 * std::ldexp(1.0, -packing.grid);
    for (std::size_t v = 0; v < numbers.size() && same; ++v) {
      same = (back.vertices[at(numbers[v])] - mesh.vertices[v]).cwiseAbs().maxCoeff() <= most;
    }
  }
  if (!same) throw InputError("pack_mesh: " + name + " does not read back as it was packed");
}

}  // namespace

void pack_mesh(std::string& archive, const std::string& name, const TriangleMesh& mesh,
               const Packing& packing) {
  ColumnWriter writer;
  writer.put(std::vector<std::uint32_t>{
      static_cast<std::uint32_t>(mesh.vertices.size()), static_cast<std::uint32_t>(mesh.triangles.size()),
      static_cast<std::uint32_t>(packing.grid), static_cast<std::uint32_t>(packing.divisions)});
  std::vector<std::int32_t> numbers;
  if (packing.grid == 0) {
    put_exact(mesh, writer);
  } else {
    const Traversal traversal(mesh, packing.grid);
    traversal.put(writer);
    numbers = traversal.numbers();
    if (std::find(numbers.begin(), numbers.end(), -1) != numbers.end()) {
      throw InputError("pack_mesh: " + name + " must be in one piece");
    }
  }
  append_entry(archive, name, writer.bytes());
  check(archive, name, mesh, packing, numbers);
}

}  // namespace palpate::geometry
