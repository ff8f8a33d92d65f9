#pragma once
#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "palpate/surface.h"

namespace palpate::net {

/// An organ's surface for clients of the live interface (docs/live-interface.md): organ frame, in mm, rounded
/// to 0.001 mm. All members: [setup], one thread, never the loop's.
class LiveSurface final {
 public:
  /// Limit of triangles, because larger answers take clients and the server's thread too long.
  static constexpr std::size_t kMaxTriangles = 20'000;

  /// @throws LiveError when the organ has more triangles than kMaxTriangles.
  explicit LiveSurface(const geometry::TriangleMesh& organ);

  /// {"vertices_mm": [x, y, z, ...], "triangles": [a, b, c, ...]}, at rest.
  [[nodiscard]] nlohmann::ordered_json at_rest() const;
  /// {"moved": [vertex, ...], "vertices_mm": [x, y, z, ...]}: the vertices that are displaced.
  [[nodiscard]] nlohmann::ordered_json moved(const model::FalloffRatios& reach,
                                             const std::vector<deform::Indentation>& indentations);

 private:
  deform::SurfaceDeformer deformer_;
  std::vector<Vec3> vertices_;
};

}  // namespace palpate::net
