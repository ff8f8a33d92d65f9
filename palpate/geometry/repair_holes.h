#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "palpate/geometry/repair_surface.h"

// Holes of an evenly turned surface whose vertices each have one fan, for repair.cc.
namespace palpate::geometry {

struct Hole {
  std::vector<std::int32_t> loop;  // vertices in the order in which a patch runs along them
  double width = 0.0;              // diagonal of its bounding box [m]
  Vec3 middle = Vec3::Zero();      // of its bounding box [m]
};

/// All boundary loops. @param mates of a surface without edges of more than two triangles
[[nodiscard]] std::vector<Hole> holes_of(const WorkSurface& surface, const Mates& mates);

/// How much one hole's patch costs to find, in steps: with n edges about n^3 / 6.
[[nodiscard]] std::uint64_t steps_to_close(const Hole& hole);

/// Triangles that close a hole, of the smallest area there is without an edge that the surface has already;
/// where there is none, a fan about a new vertex in the middle. [Barequet and Sharir 1995]
class HoleCloser final {
 public:
  explicit HoleCloser(WorkSurface& surface);

  /// @return area of the patch [m^2], without adding it
  double plan(const Hole& hole);
  /// Adds what was planned last. @return number of triangles
  std::size_t close();

 private:
  [[nodiscard]] bool has_edge(std::int32_t a, std::int32_t b) const;
  void take(std::size_t i, std::size_t j);

  WorkSurface& surface_;
  std::vector<std::uint64_t> edges_;  // sorted, before any patch: two holes share no vertex, so no edge
  std::vector<Triangle> planned_;
  std::vector<std::int32_t> loop_;
  std::vector<std::size_t> split_;
  bool needs_middle_ = false;
};

}  // namespace palpate::geometry
