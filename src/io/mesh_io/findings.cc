#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/text.h"
#include "io/mesh_io/repair/repair_slivers.h"
#include "io/mesh_io/repair/repair_surface.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

// Above this number of shells only their orientation is checked, not which lies inside which.
constexpr std::size_t kMaxShellsNested = 100;

class MeshInspection final {
 public:
  explicit MeshInspection(const geometry::TriangleMesh& mesh)
      : mesh_(mesh), shells_(mesh.triangles.size()), fans_(3 * mesh.triangles.size()) {}

  MeshFindings run() {
    walk_edges();
    const std::size_t touching = bow_tie_vertices();
    findings_.closed = !mesh_.triangles.empty() && boundary_edges_ == 0;
    findings_.manifold = !mesh_.triangles.empty() && non_manifold_edges_ == 0 && touching == 0;
    findings_.volume = geometry::signed_volume(mesh_);
    report(boundary_edges_, "boundary edge", "boundary edges");
    report(non_manifold_edges_, "edge", "edges", " of more than two triangles");
    report(inconsistent_edges_, "edge", "edges", " whose two triangles differ in orientation");
    report(touching, "vertex", "vertices", " where separate surfaces touch");
    if (const std::size_t flat = count_slivers(mesh_); flat > 0) {
      findings_.remarks.push_back(counted(flat, "triangle", "triangles") + " without area");
    }
    list_shells();
    if (findings_.closed && findings_.manifold && inconsistent_edges_ == 0) check_shells();
    return std::move(findings_);
  }

 private:
  void report(std::size_t count, std::string_view one, std::string_view more, std::string_view then = "") {
    if (count > 0) findings_.defects.push_back(fmt::format("{}{}", counted(count, one, more), then));
  }

  void walk_edges() {
    for_each_edge(sorted_half_edges(mesh_.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
      const Corner corner = first->corner;
      if (first->edge >> 32 == (first->edge & 0xffffffffU)) {  // the other two edges are the same edge
        for (const HalfEdge* side = first; side != last; ++side)
          fans_.unite(side->corner, next_corner(side->corner));
        return;
      }
      const auto triangles = last - first;
      boundary_edges_ += triangles == 1 ? 1 : 0;
      non_manifold_edges_ += triangles > 2 ? 1 : 0;
      if (triangles == 2 && vertex_at(corner) == vertex_at(first[1].corner)) ++inconsistent_edges_;
      for (const HalfEdge* side = first + 1; side != last; ++side) {
        shells_.unite(corner / 3, side->corner / 3);
        unite_fans(mesh_.triangles, corner, side->corner, fans_);
      }
    });
  }

  /// Number of vertices with more than one fan of triangles (bow-tie vertices).
  std::size_t bow_tie_vertices() {
    std::vector<std::size_t> fans_at(mesh_.vertices.size(), 0);
    for (Corner corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      if (fans_.find(corner) == corner) ++fans_at[at(vertex_at(corner))];
    }
    return static_cast<std::size_t>(
        std::count_if(fans_at.begin(), fans_at.end(), [](std::size_t fans) { return fans > 1; }));
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

  /// A shell must be oriented outwards; a cavity, oriented inwards, must be inside another shell.
  void check_shells() {
    const Vec3 origin = geometry::bounds(mesh_).middle();
    std::vector<double> volume(mesh_.triangles.size(), 0.0);  // by root
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      volume[shell_of_[t]] +=
          (point(3 * t) - origin).dot(geometry::area_vector_doubled(mesh_, mesh_.triangles[t]));
    }
    std::size_t turned = 0;
    std::size_t nested = 0;
    for (const std::size_t root : shell_roots_) {
      const bool is_inward = volume[root] < 0.0;
      if (shell_roots_.size() == 1 || shell_roots_.size() > kMaxShellsNested) {
        turned += is_inward ? 1 : 0;
        continue;
      }
      const bool is_inside = winding_of_others(root) > 0.5;
      turned += is_inward && !is_inside ? 1 : 0;
      nested += !is_inward && is_inside ? 1 : 0;
    }
    report(turned, "shell", "shells", " oriented inwards");
    report(nested, "shell", "shells", " inside another and not a cavity");
  }

  /// Winding number of all other shells at the first vertex of this one.
  [[nodiscard]] double winding_of_others(std::size_t root) const {
    const Vec3 p = point(3 * root);
    double half_angles = 0.0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (shell_of_[t] == root) continue;
      half_angles += half_solid_angle(point(3 * t) - p, point(3 * t + 1) - p, point(3 * t + 2) - p);
    }
    constexpr double kTwoPi = 6.283185307179586;
    return half_angles / kTwoPi;
  }

  [[nodiscard]] std::int32_t vertex_at(std::size_t corner) const {
    return mesh_.triangles[corner / 3][corner % 3];
  }
  [[nodiscard]] const Vec3& point(std::size_t corner) const { return mesh_.vertices[at(vertex_at(corner))]; }

  const geometry::TriangleMesh& mesh_;
  DisjointSets shells_;
  DisjointSets fans_;  // of triangle corners
  std::vector<std::uint32_t> shell_of_;
  std::vector<std::uint32_t> shell_roots_;
  std::size_t boundary_edges_ = 0;
  std::size_t non_manifold_edges_ = 0;  // with more than two triangles
  std::size_t inconsistent_edges_ = 0;  // whose two triangles do not agree in orientation
  MeshFindings findings_;
};

}  // namespace

MeshFindings findings_of(const geometry::TriangleMesh& mesh) { return MeshInspection(mesh).run(); }

}  // namespace palpate::mesh_io
