#include "io/mesh_io/repair/repair_slivers.h"

#include <algorithm>
#include <vector>

namespace palpate::mesh_io {
namespace {

// A round tries each sliver once; removing one may make the next removable.
constexpr int kMaxRounds = 20;
// An edge shorter than this fraction of its triangle's longest edge is collapsed.
constexpr double kNoLength = 4e-7;

/// One round over all slivers. Triangles next to a change wait for the next round, since the opposite
/// half-edges are computed once per round.
class Round final {
 public:
  explicit Round(WorkSurface& surface)
      : surface_(surface),
        opposite_(pair_half_edges(surface)),
        touched_(surface.mesh.vertices.size(), 0),
        doomed_(surface.mesh.triangles.size(), 0) {}

  /// @return whether anything changed
  bool run() {
    bool changed = false;
    for (std::uint32_t t = 0; t < doomed_.size(); ++t) {
      if (doomed_[t] != 0 || !is_sliver(surface_.mesh, surface_.mesh.triangles[t])) continue;
      Corner shortest = 3 * t;
      Corner longest = 3 * t;
      for (Corner c = 3 * t + 1; c < 3 * t + 3; ++c) {
        if (length(c) < length(shortest)) shortest = c;
        if (length(c) > length(longest)) longest = c;
      }
      const bool is_needle = length(shortest) <= kNoLength * length(longest);
      if (is_needle ? shrink(shortest) : flip(longest)) changed = true;
    }
    surface_.drop(doomed_);
    return changed;
  }

 private:
  [[nodiscard]] double length(Corner c) const {
    return (surface_.point_at(next_corner(c)) - surface_.point_at(c)).norm();
  }

  /// The triangles around the vertex of a corner, as their corners there; empty where the surface is open or
  /// already changed.
  [[nodiscard]] std::vector<Corner> ring(Corner start) const {
    std::vector<Corner> corners;
    Corner c = start;
    do {
      const geometry::Triangle& triangle = surface_.mesh.triangles[c / 3];
      if (opposite_[c] == kNoOpposite || corners.size() > 100) return {};
      for (const std::int32_t v : triangle) {
        if (touched_[static_cast<std::size_t>(v)] != 0) return {};
      }
      corners.push_back(c);
      c = next_corner(opposite_[c]);
    } while (c != start);
    return corners;
  }

  void touch(const std::vector<Corner>& corners) {
    for (const Corner c : corners) {
      for (const std::int32_t v : surface_.mesh.triangles[c / 3]) touched_[static_cast<std::size_t>(v)] = 1;
    }
  }

  /// Collapses the edge of a corner to its start. Its ends may share only the two neighbours opposite the
  /// edge: otherwise the surface would become non-manifold.
  bool shrink(Corner c) {
    const std::vector<Corner> about_kept = ring(c);
    const std::vector<Corner> about_gone = ring(next_corner(c));
    if (about_kept.empty() || about_gone.empty()) return false;
    int common = 0;
    for (const Corner a : about_kept) {
      for (const Corner b : about_gone)
        common += surface_.vertex_at(next_corner(a)) == surface_.vertex_at(next_corner(b)) ? 1 : 0;
    }
    if (common != 2 || about_kept.size() + about_gone.size() < 7) return false;
    const std::int32_t kept = surface_.vertex_at(c);
    touch(about_kept);
    touch(about_gone);
    for (const Corner b : about_gone) surface_.mesh.triangles[b / 3][b % 3] = kept;
    doomed_[c / 3] = doomed_[opposite_[c] / 3] = 1;
    return true;
  }

  /// Flips the edge of a corner to the other diagonal of its two triangles, if that leaves fewer slivers.
  bool flip(Corner c) {
    const Corner across = opposite_[c];
    if (across == kNoOpposite) return false;
    const std::vector<Corner> about_apex = ring(previous_corner(c));
    const std::vector<Corner> about_other = ring(previous_corner(across));
    if (about_apex.empty() || about_other.empty()) return false;
    const std::int32_t a = surface_.vertex_at(c);
    const std::int32_t b = surface_.vertex_at(across);
    const std::int32_t p = surface_.vertex_at(previous_corner(c));
    const std::int32_t q = surface_.vertex_at(previous_corner(across));
    if (p == q) return false;
    for (const Corner corner : about_apex) {
      if (surface_.vertex_at(next_corner(corner)) == q) return false;
    }
    const auto flat = [&](const geometry::Triangle& t) { return is_sliver(surface_.mesh, t) ? 1 : 0; };
    const int before = 1 + flat(surface_.mesh.triangles[across / 3]);
    if (flat({a, q, p}) + flat({q, b, p}) >= before) return false;
    touch(about_apex);
    touch(about_other);
    surface_.mesh.triangles[c / 3] = {a, q, p};
    surface_.mesh.triangles[across / 3] = {q, b, p};
    return true;
  }

  WorkSurface& surface_;
  Opposites opposite_;
  std::vector<std::uint8_t> touched_;  // vertices
  std::vector<std::uint8_t> doomed_;   // triangles
};

}  // namespace

bool is_sliver(const geometry::TriangleMesh& mesh, const geometry::Triangle& triangle) {
  double longest_squared = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(triangle[k])];
    const Vec3& b = mesh.vertices[static_cast<std::size_t>(triangle[(k + 1) % 3])];
    longest_squared = std::max(longest_squared, (b - a).squaredNorm());
  }
  return geometry::area_vector_doubled(mesh, triangle).norm() <= kFlat * longest_squared;
}

std::size_t count_slivers(const geometry::TriangleMesh& mesh) {
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                    [&](const geometry::Triangle& t) { return is_sliver(mesh, t); }));
}

std::size_t remove_slivers(WorkSurface& surface) {
  const std::size_t before = count_slivers(surface.mesh);
  if (before == 0) return 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (!Round(surface).run()) break;
  }
  const std::size_t after = count_slivers(surface.mesh);
  return before - std::min(before, after);
}

}  // namespace palpate::mesh_io
