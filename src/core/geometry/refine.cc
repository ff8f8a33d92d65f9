// refine(): splits long edges.
#include <algorithm>
#include <cmath>
#include <queue>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/geometry/half_edges.h"
#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

// refine() throws beyond this many triangles: a wrong unit must not exhaust the memory.
constexpr std::size_t kMaxRefinedTriangles = 4'000'000;

[[noreturn]] void refuse_as_too_many() {
  throw InputError("refining the mesh needs more than " + std::to_string(kMaxRefinedTriangles) +
                   " triangles: is its unit right?");
}

/// Splits edges, longest first; equal lengths in the order of their vertex indices. An edge inside an
/// original triangle is flipped when the other diagonal is shorter and improves the triangles. So a long thin
/// triangle becomes a strip, not a set of slivers.
class Refiner final {
 public:
  Refiner(const TriangleMesh& mesh, double longest) : mesh_(mesh), longest_squared_(longest * longest) {
    // Triangles without a long edge keep their edges, so a mesh that is already fine costs one pass.
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Triangle corners = mesh_.triangles[t];
      if (!is_long(corners[0], corners[1]) && !is_long(corners[1], corners[2]) &&
          !is_long(corners[2], corners[0])) {
        continue;
      }
      for (std::size_t e = 0; e < 3; ++e) {
        attach(corners[e], corners[(e + 1) % 3], static_cast<std::int32_t>(t), false);
      }
    }
  }

  TriangleMesh run() {
    while (!longest_first_.empty()) {
      const std::uint64_t key = longest_first_.top().key;
      longest_first_.pop();
      const auto found = edges_.find(key);
      if (found == edges_.end()) continue;  // flipped meanwhile
      if (found->second.is_inner && turn(key)) continue;
      split(key);
      if (mesh_.triangles.size() > kMaxRefinedTriangles) refuse_as_too_many();
    }
    return std::move(mesh_);
  }

 private:
  struct Edge {
    std::vector<std::int32_t> triangles;
    bool is_inner = false;  // inside an original triangle, so between coplanar triangles
  };

  struct Candidate {
    double rank;  // squared length, smaller for an inner edge, so that its neighbours come first
    std::uint64_t key;
    bool operator<(const Candidate& other) const {
      return rank != other.rank ? rank < other.rank : key > other.key;
    }
  };

  void attach(std::int32_t a, std::int32_t b, std::int32_t triangle, bool is_inner) {
    const std::uint64_t key = edge_key(a, b);
    Edge& edge = edges_[key];
    if (edge.triangles.empty()) {
      edge.is_inner = is_inner;
      if (is_long(a, b)) longest_first_.push({(is_inner ? 0.5 : 1.0) * squared_length(a, b), key});
    }
    edge.triangles.push_back(triangle);
  }

  void replace(std::int32_t a, std::int32_t b, std::int32_t old_triangle, std::int32_t new_triangle) {
    for (std::int32_t& triangle : edges_[edge_key(a, b)].triangles) {
      if (triangle == old_triangle) triangle = new_triangle;
    }
  }

  /// The triangle's corners: the two of the edge, then the opposite one.
  [[nodiscard]] Triangle from_edge(std::int32_t triangle, std::uint64_t key) const {
    Triangle corners = mesh_.triangles[static_cast<std::size_t>(triangle)];
    while (edge_key(corners[0], corners[1]) != key)
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    return corners;
  }

  void split(std::uint64_t key) {
    const auto low = static_cast<std::int32_t>(key >> 32);
    const auto high = static_cast<std::int32_t>(key & 0xffffffffU);
    const auto middle = static_cast<std::int32_t>(mesh_.vertices.size());
    const Vec3 point = 0.5 * (vertex(low) + vertex(high));
    mesh_.vertices.push_back(point);
    const Edge whole = std::move(edges_[key]);
    edges_.erase(key);
    for (const std::int32_t t : whole.triangles) {
      const auto [from, to, apex] = from_edge(t, key);
      const auto added = static_cast<std::int32_t>(mesh_.triangles.size());
      mesh_.triangles[static_cast<std::size_t>(t)] = {from, middle, apex};
      mesh_.triangles.push_back({middle, to, apex});
      replace(to, apex, t, added);
      attach(from, middle, t, whole.is_inner);
      attach(middle, to, added, whole.is_inner);
      attach(middle, apex, t, true);
      attach(middle, apex, added, true);
    }
  }

  /// Flips an inner edge if the other diagonal is shorter and improves the triangles.
  bool turn(std::uint64_t key) {
    // of the squared length: at least a tenth shorter, so that flipping ends
    constexpr double kShorter = 0.81;
    const std::vector<std::int32_t> around = edges_[key].triangles;
    if (around.size() != 2) return false;
    const auto [a, b, p] = from_edge(around[0], key);
    const std::int32_t q = from_edge(around[1], key)[2];
    if (squared_length(p, q) > kShorter * squared_length(a, b)) return false;
    const Vec3 normal = area_vector_doubled(mesh_, {a, b, p});
    const double before = std::min(shape({a, b, p}, normal), shape({b, a, q}, normal));
    if (std::min(shape({a, q, p}, normal), shape({q, b, p}, normal)) <= before) return false;
    edges_.erase(key);
    mesh_.triangles[static_cast<std::size_t>(around[0])] = {a, q, p};
    mesh_.triangles[static_cast<std::size_t>(around[1])] = {q, b, p};
    replace(a, q, around[1], around[0]);
    replace(b, p, around[0], around[1]);
    attach(p, q, around[0], true);
    attach(p, q, around[1], true);
    return true;
  }

  /// Area over squared edges, up to a factor common to one plane; negative when inverted relative to
  /// `normal`.
  [[nodiscard]] double shape(const Triangle& triangle, const Vec3& normal) const {
    const double squares = squared_length(triangle[0], triangle[1]) +
                           squared_length(triangle[1], triangle[2]) +
                           squared_length(triangle[2], triangle[0]);
    return area_vector_doubled(mesh_, triangle).dot(normal) / squares;
  }

  [[nodiscard]] bool is_long(std::int32_t a, std::int32_t b) const {
    return squared_length(a, b) > longest_squared_;
  }

  /// Gives the same bits for both orders of the ends.
  [[nodiscard]] double squared_length(std::int32_t a, std::int32_t b) const {
    return (vertex(std::max(a, b)) - vertex(std::min(a, b))).squaredNorm();
  }

  [[nodiscard]] const Vec3& vertex(std::int32_t index) const {
    return mesh_.vertices[static_cast<std::size_t>(index)];
  }

  TriangleMesh mesh_;
  double longest_squared_;
  std::unordered_map<std::uint64_t, Edge> edges_;
  std::priority_queue<Candidate> longest_first_;
};

}  // namespace

TriangleMesh refine(const TriangleMesh& mesh, double longest) {
  if (!(longest > 0.0)) throw ParameterError("longest edge (m)", longest, "> 0");
  // The equilateral triangle has the largest area of any in the result.
  const double most_area =
      0.25 * std::sqrt(3.0) * longest * longest * static_cast<double>(kMaxRefinedTriangles);
  double doubled_area = 0.0;
  for (const Triangle& triangle : mesh.triangles) doubled_area += area_vector_doubled(mesh, triangle).norm();
  if (!(0.5 * doubled_area <= most_area)) refuse_as_too_many();
  return Refiner(mesh, longest).run();
}

}  // namespace palpate::geometry
