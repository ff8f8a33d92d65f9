#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "palpate/geometry/read_mesh.h"

namespace palpate::geometry {
namespace {

// A triangle lower than this share of its longest edge has no area but the rounding of 32-bit coordinates.
constexpr double kFlat = 2e-7;

// With more shells than this their nesting is not looked into, only their turning.
constexpr std::size_t kMostShellsNested = 100;

class DisjointSets final {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::size_t find(std::size_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void unite(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

struct HalfEdge {
  std::int32_t low, high;
  std::size_t corner;  // 3 triangle + k: runs from corner k to the next
  bool ascending;
};

struct Counts {
  std::size_t boundary_edges = 0;
  std::size_t crowded_edges = 0;  // of more than two triangles
  std::size_t turned_edges = 0;   // whose two triangles run the same way
  std::size_t fan_vertices = 0;
  std::size_t flat_triangles = 0;
};

std::size_t next_corner(std::size_t corner) { return corner - corner % 3 + (corner + 1) % 3; }

class Analysis final {
 public:
  explicit Analysis(const TriangleMesh& mesh)
      : mesh_(mesh), shells_(mesh.triangles.size()), fans_(3 * mesh.triangles.size()) {}

  MeshFindings run() {
    collect_half_edges();
    walk_edges();
    count_fans();
    count_flat();
    findings_.closed = !mesh_.triangles.empty() && counts_.boundary_edges == 0;
    findings_.manifold = !mesh_.triangles.empty() && counts_.crowded_edges == 0 && counts_.fan_vertices == 0;
    findings_.volume = signed_volume(mesh_);
    say(counts_.boundary_edges, "boundary edge");
    say(counts_.crowded_edges, "edge", " of more than two triangles");
    say(counts_.turned_edges, "edge", " whose two triangles are turned against each other");
    say(counts_.fan_vertices, "vertex", " where separate surfaces touch");
    say(counts_.flat_triangles, "triangle", " without area");
    list_shells();
    if (findings_.closed && findings_.manifold && counts_.turned_edges == 0) judge_shells();
    return std::move(findings_);
  }

 private:
  void say(std::size_t count, const std::string& what, const std::string& more = "") {
    if (count == 0) return;
    const std::string plural = what == "vertex" ? "vertices" : what + "s";
    findings_.defects.push_back(std::to_string(count) + " " + (count == 1 ? what : plural) + more);
  }

  void collect_half_edges() {
    half_edges_.reserve(3 * mesh_.triangles.size());
    for (std::size_t corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      const std::int32_t from = vertex_at(corner);
      const std::int32_t to = vertex_at(next_corner(corner));
      if (from == to) {  // the other two edges of such a triangle are one
        fans_.unite(corner, next_corner(corner));
        continue;
      }
      half_edges_.push_back({std::min(from, to), std::max(from, to), corner, from < to});
    }
    std::sort(half_edges_.begin(), half_edges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
      if (a.low != b.low) return a.low < b.low;
      return a.high != b.high ? a.high < b.high : a.corner < b.corner;
    });
  }

  void walk_edges() {
    for (std::size_t first = 0; first < half_edges_.size();) {
      std::size_t end = first + 1;
      while (end < half_edges_.size() && half_edges_[end].low == half_edges_[first].low &&
             half_edges_[end].high == half_edges_[first].high) {
        ++end;
      }
      const std::size_t triangles = end - first;
      counts_.boundary_edges += triangles == 1 ? 1 : 0;
      counts_.crowded_edges += triangles > 2 ? 1 : 0;
      if (triangles == 2 && half_edges_[first].ascending == half_edges_[first + 1].ascending)
        ++counts_.turned_edges;
      for (std::size_t other = first + 1; other < end; ++other) join(half_edges_[first], half_edges_[other]);
      first = end;
    }
  }

  /// Two triangles at one edge are of one shell, and of one fan about each end.
  void join(const HalfEdge& a, const HalfEdge& b) {
    shells_.unite(a.corner / 3, b.corner / 3);
    const auto at = [](const HalfEdge& edge, bool low_end) {
      return edge.ascending == low_end ? edge.corner : next_corner(edge.corner);
    };
    fans_.unite(at(a, true), at(b, true));
    fans_.unite(at(a, false), at(b, false));
  }

  void count_fans() {
    std::vector<std::size_t> fans_at(mesh_.vertices.size(), 0);
    for (std::size_t corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      if (fans_.find(corner) == corner) ++fans_at[static_cast<std::size_t>(vertex_at(corner))];
    }
    counts_.fan_vertices = static_cast<std::size_t>(
        std::count_if(fans_at.begin(), fans_at.end(), [](std::size_t fans) { return fans > 1; }));
  }

  void count_flat() {
    for (const Triangle& triangle : mesh_.triangles) {
      double longest_squared = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = mesh_.vertices[static_cast<std::size_t>(triangle[k])];
        const Vec3& b = mesh_.vertices[static_cast<std::size_t>(triangle[(k + 1) % 3])];
        longest_squared = std::max(longest_squared, (b - a).squaredNorm());
      }
      if (area_vector_doubled(mesh_, triangle).norm() <= kFlat * longest_squared) ++counts_.flat_triangles;
    }
  }

  void list_shells() {
    shell_of_.resize(mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::size_t root = shells_.find(t);
      if (root == t) shell_roots_.push_back(t);
      shell_of_[t] = root;
    }
    findings_.shells = static_cast<int>(shell_roots_.size());
  }

  /// A shell must be turned outwards, and a cavity (turned inwards) must lie in another shell.
  void judge_shells() {
    const Vec3 origin = bounds(mesh_).middle();
    std::vector<double> volume(mesh_.triangles.size(), 0.0);  // by root
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      volume[shell_of_[t]] += (point(3 * t) - origin).dot(area_vector_doubled(mesh_, mesh_.triangles[t]));
    }
    std::size_t turned = 0;
    std::size_t nested = 0;
    for (const std::size_t root : shell_roots_) {
      const bool is_inward = volume[root] < 0.0;
      if (shell_roots_.size() == 1 || shell_roots_.size() > kMostShellsNested) {
        turned += is_inward ? 1 : 0;
        continue;
      }
      const bool is_inside = winding_of_others(root) > 0.5;
      turned += is_inward && !is_inside ? 1 : 0;
      nested += !is_inward && is_inside ? 1 : 0;
    }
    say(turned, "shell", " turned inwards");
    say(nested, "shell", " inside another and not a cavity");
  }

  /// Winding number of all other shells about the first vertex of this one [van Oosterom and Strackee 1983].
  [[nodiscard]] double winding_of_others(std::size_t root) const {
    const Vec3 p = point(3 * root);
    double half_angles = 0.0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (shell_of_[t] == root) continue;
      const Vec3 a = point(3 * t) - p;
      const Vec3 b = point(3 * t + 1) - p;
      const Vec3 c = point(3 * t + 2) - p;
      const double la = a.norm();
      const double lb = b.norm();
      const double lc = c.norm();
      // not in a tick
      half_angles +=
          std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    constexpr double kTwoPi = 6.283185307179586;
    return half_angles / kTwoPi;
  }

  [[nodiscard]] std::int32_t vertex_at(std::size_t corner) const {
    return mesh_.triangles[corner / 3][corner % 3];
  }
  [[nodiscard]] const Vec3& point(std::size_t corner) const {
    return mesh_.vertices[static_cast<std::size_t>(vertex_at(corner))];
  }

  const TriangleMesh& mesh_;
  std::vector<HalfEdge> half_edges_;
  DisjointSets shells_;
  DisjointSets fans_;  // of triangle corners
  std::vector<std::size_t> shell_of_;
  std::vector<std::size_t> shell_roots_;
  Counts counts_;
  MeshFindings findings_;
};

}  // namespace

MeshFindings findings_of(const TriangleMesh& mesh) { return Analysis(mesh).run(); }

}  // namespace palpate::geometry
