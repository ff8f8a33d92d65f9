#pragma once
#include <vector>

#include "core/deform/deformed_surface.h"
#include "palpate/tool.h"
#include "view/render/gl_objects.h"

namespace palpate::render {

/// An instrument for display: curved faces smoothed, sharp edges kept.
class ToolPicture final {
 public:
  /// [setup]
  explicit ToolPicture(const geometry::Tool& tool);

  [[nodiscard]] std::size_t parts() const noexcept { return parts_.size(); }
  /// [setup] Corners of a part's triangles (three per triangle), in the part's frame.
  [[nodiscard]] std::vector<deform::SurfaceVertex> corners(std::size_t part) const;
  /// [any] World pose of a part.
  [[nodiscard]] Pose part_pose(std::size_t part, const Pose& handle_W, double gripper) const;

 private:
  struct Part {
    geometry::ToolPart part;    // with its refined mesh
    std::vector<Vec3> normals;  // one per corner
  };
  std::vector<Part> parts_;
};

}  // namespace palpate::render
