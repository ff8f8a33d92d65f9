// refine(): splits long edges.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "core/base/index.h"
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

struct Edge {
  std::array<std::int32_t, 2> two{-1, -1};  // triangles at the edge
  std::vector<std::int32_t> more{};         // where more than two meet
  bool is_inner = false;                    // inside an original triangle, so between coplanar triangles

  [[nodiscard]] bool is_gone() const noexcept { return two[0] < 0; }
  void add(std::int32_t triangle) {
    const auto free = std::find(two.begin(), two.end(), -1);
    if (free != two.end()) {
      *free = triangle;
    } else {
      more.push_back(triangle);
    }
  }
  /// The triangles in the order in which they were added. Leaves none.
  std::vector<std::int32_t> take() {
    std::vector<std::int32_t> all(two.begin(), std::find(two.begin(), two.end(), -1));
    all.insert(all.end(), more.begin(), more.end());
    two = {-1, -1};
    more.clear();
    return all;
  }
};

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
      const Edge& edge = edge_of(key);
      if (edge.is_gone()) continue;  // flipped meanwhile
      if (edge.is_inner && turn(key)) continue;
      split(key);
      if (mesh_.triangles.size() > kMaxRefinedTriangles) refuse_as_too_many();
    }
    return std::move(mesh_);
  }

 private:
  struct Candidate {
    double rank;  // squared length, smaller for an inner edge, so that its neighbours come first
    std::uint64_t key;
    bool operator<(const Candidate& other) const {
      return rank != other.rank ? rank < other.rank : key > other.key;
    }
  };

  Edge& edge_of(std::uint64_t key) {
    const std::size_t number = at(numbers_[key]);
    if (number == edges_.size()) edges_.emplace_back();
    return edges_[number];
  }

  void attach(std::int32_t a, std::int32_t b, std::int32_t triangle, bool is_inner) {
    const std::uint64_t key = edge_key(a, b);
    Edge& edge = edge_of(key);
    if (edge.is_gone()) {
      edge.is_inner = is_inner;
      if (is_long(a, b)) longest_first_.push({(is_inner ? 0.5 : 1.0) * squared_length(a, b), key});
    }
    edge.add(triangle);
  }

  void replace(std::int32_t a, std::int32_t b, std::int32_t old_triangle, std::int32_t new_triangle) {
    Edge& edge = edge_of(edge_key(a, b));
    std::replace(edge.two.begin(), edge.two.end(), old_triangle, new_triangle);
    std::replace(edge.more.begin(), edge.more.end(), old_triangle, new_triangle);
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
    Edge& whole = edge_of(key);
    const bool is_inner = whole.is_inner;
    for (const std::int32_t t : whole.take()) {
      const auto [from, to, apex] = from_edge(t, key);
      const auto added = static_cast<std::int32_t>(mesh_.triangles.size());
      mesh_.triangles[static_cast<std::size_t>(t)] = {from, middle, apex};
      mesh_.triangles.push_back({middle, to, apex});
      replace(to, apex, t, added);
      attach(from, middle, t, is_inner);
      attach(middle, to, added, is_inner);
      attach(middle, apex, t, true);
      attach(middle, apex, added, true);
    }
  }

  /// Flips an inner edge if the other diagonal is shorter and improves the triangles.
  bool turn(std::uint64_t key) {
    // of the squared length: at least a tenth shorter, so that flipping ends
    constexpr double kShorter = 0.81;
    Edge& edge = edge_of(key);
    if (edge.two[1] < 0 || !edge.more.empty()) return false;
    const std::array<std::int32_t, 2> around = edge.two;
    const auto [a, b, p] = from_edge(around[0], key);
    const std::int32_t q = from_edge(around[1], key)[2];
    if (squared_length(p, q) > kShorter * squared_length(a, b)) return false;
    const Vec3 normal = area_vector_doubled(mesh_, {a, b, p});
    const double before = std::min(shape({a, b, p}, normal), shape({b, a, q}, normal));
    if (std::min(shape({a, q, p}, normal), shape({q, b, p}, normal)) <= before) return false;
    (void)edge.take();
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
  EdgeNumbers numbers_;
  std::vector<Edge> edges_;  // by number
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
