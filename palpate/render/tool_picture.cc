#include "palpate/render/tool_picture.h"

#include <numbers>

#include "palpate/render/display_mesh.h"

namespace palpate::render {
namespace {

constexpr double kCreaseDeg = 40.0;
constexpr double kLargestBend = 8.0 * std::numbers::pi / 180.0;  // between the ends of an edge as drawn
constexpr double kShortestEdge = 0.3e-3;                         // m: shorter ones are not split

}  // namespace

ToolPicture::ToolPicture(const geometry::Tool& tool) {
  const RefineRule rule{kCreaseDeg, [](const Vec3&, double length, double bend) {
                          return bend > kLargestBend && length > kShortestEdge;
                        }};
  for (const geometry::ToolPart& part : tool.parts) {
    Part drawn{part, {}};
    drawn.part.mesh = refine_smoothly(part.mesh, rule);
    drawn.normals = corner_normals(drawn.part.mesh, kCreaseDeg);
    parts_.push_back(std::move(drawn));
  }
}

void ToolPicture::append(const Pose& handle_W, double gripper, std::vector<Vertex>& corners) const {
  for (const Part& drawn : parts_) {
    const Pose part_W = handle_W * geometry::part_pose(drawn.part, gripper);
    std::size_t corner = 0;
    for (const geometry::Triangle& t : drawn.part.mesh.triangles) {
      for (const std::int32_t v : t) {
        const Vec3& p = drawn.part.mesh.vertices[static_cast<std::size_t>(v)];
        corners.push_back({(part_W * p).cast<float>(),
                           (part_W.rotation * drawn.normals[corner]).cast<float>(), p.cast<float>()});
        ++corner;
      }
    }
  }
}

}  // namespace palpate::render
