#include "view/render/tool_picture.h"

#include <numbers>

#include "view/render/display_mesh.h"

namespace palpate::render {
namespace {

constexpr double kToolCreaseDeg = 40.0;
constexpr double kLargestBend = 8.0 * std::numbers::pi / 180.0;  // largest angle between the normals at the
                                                                 // ends of a displayed edge
constexpr double kShortestToolEdge = 0.3e-3;                     // m: shorter edges are not split

}  // namespace

ToolPicture::ToolPicture(const geometry::Tool& tool) {
  const RefineRule rule{kToolCreaseDeg, [](const Vec3&, double length, double bend) {
                          return bend > kLargestBend && length > kShortestToolEdge;
                        }};
  for (const geometry::ToolPart& part : tool.parts) {
    Part drawn{part, {}};
    drawn.part.mesh = refine_smoothly(part.mesh, rule);
    drawn.normals = corner_normals(drawn.part.mesh, kToolCreaseDeg);
    parts_.push_back(std::move(drawn));
  }
}

std::vector<deform::SurfaceVertex> ToolPicture::corners(std::size_t part) const {
  const Part& drawn = parts_.at(part);
  std::vector<deform::SurfaceVertex> corners;
  for (const geometry::Triangle& t : drawn.part.mesh.triangles) {
    for (const std::int32_t v : t) {
      const Vec3& p = drawn.part.mesh.vertices[static_cast<std::size_t>(v)];
      corners.push_back(
          deform::SurfaceVertex{p.cast<float>(), drawn.normals[corners.size()].cast<float>(), 0.0F});
    }
  }
  return corners;
}

Pose ToolPicture::part_pose(std::size_t part, const Pose& handle_W, double gripper) const {
  return handle_W * geometry::part_pose(parts_.at(part).part, gripper);
}

}  // namespace palpate::render
