#pragma once
#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "palpate/surface.h"
#include "palpate/tick_observer.h"
#include "palpate/tool.h"

namespace palpate::net {

/// An organ's surface for clients of the live interface (docs/live-interface.md): organ frame, in mm, rounded
/// to 0.001 mm. All members: [setup], one thread, never the loop's.
class LiveSurface final {
 public:
  /// Limit of triangles, because larger answers take clients and the server's thread too long.
  static constexpr std::size_t kMaxTriangles = 20'000;

  /// @throws LiveError when the organ has more triangles than kMaxTriangles.
  explicit LiveSurface(const geometry::TriangleMesh& organ,
                       const std::optional<geometry::Support>& support = {},
                       const contact::OrganStore* store = nullptr);

  /// {"vertices_mm": [x, y, z, ...], "triangles": [a, b, c, ...]}, at rest.
  [[nodiscard]] nlohmann::ordered_json at_rest() const;
  /// {"moved": [vertex, ...], "vertices_mm": [x, y, z, ...]}: the vertices that are displaced.
  [[nodiscard]] nlohmann::ordered_json moved(const model::FalloffRatios& reach,
                                             const std::vector<deform::Indentation>& indentations);

 private:
  deform::SurfaceDeformer deformer_;
  std::vector<Vec3> vertices_;
};

/// {"parts": [...]}: the meshes of an instrument in the handle's frame, and how its jaws turn. [setup]
/// @throws LiveError when it has more triangles than LiveSurface::kMaxTriangles.
[[nodiscard]] nlohmann::ordered_json tool_json(const geometry::Tool& tool);

/// Poses, jaws and contacts of a tick, from which a client draws the picture. [any]
[[nodiscard]] nlohmann::ordered_json picture_json(const haptics::Snapshot& snapshot);

}  // namespace palpate::net
