#pragma once
#include <vector>

#include "core/deform/live_surface.h"
#include "palpate/tool.h"
#include "view/render/gl_objects.h"

namespace palpate::render {

/// An instrument as it is drawn: round where its mesh means to be, sharp at its edges.
class ToolPicture final {
 public:
  /// [setup]
  explicit ToolPicture(const geometry::Tool& tool);

  [[nodiscard]] std::size_t parts() const noexcept { return parts_.size(); }
  /// [setup] The corners of a part's triangles, three a triangle, in its own frame.
  [[nodiscard]] std::vector<deform::LiveVertex> corners(std::size_t part) const;
  /// [any] Where a part is.
  [[nodiscard]] Pose place(std::size_t part, const Pose& handle_W, double gripper) const;

 private:
  struct Part {
    geometry::ToolPart part;    // its mesh refined
    std::vector<Vec3> normals;  // a corner
  };
  std::vector<Part> parts_;
};

}  // namespace palpate::render
