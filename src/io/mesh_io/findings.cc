#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "io/mesh_io/repair/repair_slivers.h"
#include "io/mesh_io/repair/repair_surface.h"
#include "palpate/read_mesh.h"

namespace palpate::geometry {
namespace {

// With more shells than this their nesting is not looked into, only their turning.
constexpr std::size_t kMostShellsNested = 100;

struct Counts {
  std::size_t boundary_edges = 0;
  std::size_t crowded_edges = 0;  // of more than two triangles
  std::size_t turned_edges = 0;   // whose two triangles run the same way
  std::size_t fan_vertices = 0;
  std::size_t flat_triangles = 0;
};

class Analysis final {
 public:
  explicit Analysis(const TriangleMesh& mesh)
      : mesh_(mesh), shells_(mesh.triangles.size()), fans_(3 * mesh.triangles.size()) {}

  MeshFindings run() {
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
    if (counts_.flat_triangles > 0) {
      findings_.remarks.push_back(fmt::format("{}{} without area", counts_.flat_triangles,
                                              counts_.flat_triangles == 1 ? " triangle" : " triangles"));
    }
    list_shells();
    if (findings_.closed && findings_.manifold && counts_.turned_edges == 0) judge_shells();
    return std::move(findings_);
  }

 private:
  void say(std::size_t count, const std::string& what, const std::string& more = "") {
    if (count == 0) return;
    const std::string plural = what == "vertex" ? "vertices" : what + "s";
    findings_.defects.push_back(fmt::format("{} {}{}", count, count == 1 ? what : plural, more));
  }

  void walk_edges() {
    for_each_edge(sorted_sides(mesh_.triangles), [&](const EdgeSide* first, const EdgeSide* last) {
      const Corner corner = first->corner;
      if (first->edge >> 32 ==
          (first->edge & 0xffffffffU)) {  // the other two edges of such a triangle are one
        for (const EdgeSide* side = first; side != last; ++side)
          fans_.unite(side->corner, next_corner(side->corner));
        return;
      }
      const auto triangles = last - first;
      counts_.boundary_edges += triangles == 1 ? 1 : 0;
      counts_.crowded_edges += triangles > 2 ? 1 : 0;
      if (triangles == 2 && vertex_at(corner) == vertex_at(first[1].corner)) ++counts_.turned_edges;
      for (const EdgeSide* side = first + 1; side != last; ++side) join(corner, side->corner);
    });
  }

  /// Two triangles at one edge are of one shell, and of one fan about each end.
  void join(Corner a, Corner b) {
    shells_.unite(a / 3, b / 3);
    const bool runs_along = vertex_at(a) == vertex_at(b);
    fans_.unite(a, runs_along ? b : next_corner(b));
    fans_.unite(next_corner(a), runs_along ? next_corner(b) : b);
  }

  void count_fans() {
    std::vector<std::size_t> fans_at(mesh_.vertices.size(), 0);
    for (Corner corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      if (fans_.find(corner) == corner) ++fans_at[static_cast<std::size_t>(vertex_at(corner))];
    }
    counts_.fan_vertices = static_cast<std::size_t>(
        std::count_if(fans_at.begin(), fans_at.end(), [](std::size_t fans) { return fans > 1; }));
  }

  void count_flat() {
    counts_.flat_triangles = static_cast<std::size_t>(
        std::count_if(mesh_.triangles.begin(), mesh_.triangles.end(),
                      [&](const Triangle& triangle) { return is_flat(mesh_, triangle); }));
  }

  void list_shells() {
    shell_of_.resize(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::uint32_t root = shells_.find(t);
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
  DisjointSets shells_;
  DisjointSets fans_;  // of triangle corners
  std::vector<std::uint32_t> shell_of_;
  std::vector<std::uint32_t> shell_roots_;
  Counts counts_;
  MeshFindings findings_;
};

}  // namespace

MeshFindings findings_of(const TriangleMesh& mesh) { return Analysis(mesh).run(); }

}  // namespace palpate::geometry
