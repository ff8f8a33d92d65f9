#pragma once
#include <vector>

#include "palpate/geometry/tool.h"
#include "palpate/render/gl_objects.h"

namespace palpate::render {

/// An instrument as it is drawn: round where its mesh means to be, sharp at its edges.
class ToolPicture final {
 public:
  /// [setup]
  explicit ToolPicture(const geometry::Tool& tool);

  /// [setup] Appends the corners of all triangles, three a triangle, in the world.
  void append(const Pose& handle_W, double gripper, std::vector<Vertex>& corners) const;

 private:
  struct Part {
    geometry::ToolPart part;    // its mesh refined
    std::vector<Vec3> normals;  // a corner
  };
  std::vector<Part> parts_;
};

}  // namespace palpate::render
