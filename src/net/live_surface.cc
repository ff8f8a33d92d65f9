#include "net/live_surface.h"

#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "net/live_protocol.h"
#include "palpate/units.h"

namespace palpate::net {
namespace {

using Json = nlohmann::ordered_json;

void check_triangles(const char* what, std::size_t triangles) {
  if (triangles <= LiveSurface::kMaxTriangles) return;
  throw LiveError("refused", fmt::format("{} has {} triangles, must have at most {} to be sent", what,
                                         triangles, LiveSurface::kMaxTriangles));
}

const geometry::TriangleMesh& checked(const geometry::TriangleMesh& organ) {
  check_triangles("surface: the organ", organ.triangles.size());
  return organ;
}

void append(Json& list, const Vec3& point) {
  constexpr double kSteps = 1000.0;  // steps per millimetre
  for (int axis = 0; axis < 3; ++axis) {
    list.push_back(std::round(point[axis] / kMillimetre * kSteps) / kSteps);
  }
}

Json mesh_json(const geometry::TriangleMesh& mesh) {
  Json vertices = Json::array();
  Json triangles = Json::array();
  for (const Vec3& vertex : mesh.vertices) append(vertices, vertex);
  for (const geometry::Triangle& triangle : mesh.triangles) {
    for (const auto corner : triangle) triangles.push_back(corner);
  }
  return {{"vertices_mm", vertices}, {"triangles", triangles}};
}

Json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json list(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

}  // namespace

LiveSurface::LiveSurface(const geometry::TriangleMesh& organ, const std::optional<geometry::Support>& support,
                         const contact::OrganStore* store)
    : deformer_(checked(organ), deform::prepare_response(organ, support, store)) {}

Json LiveSurface::at_rest() const { return mesh_json(deformer_.rest()); }

Json LiveSurface::moved(const model::FalloffRatios& reach,
                        const std::vector<deform::Indentation>& indentations) {
  deformer_.deform(reach, indentations, vertices_);
  Json moved = Json::array();
  Json vertices = Json::array();
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (vertices_[i] == deformer_.rest().vertices[i]) continue;
    moved.push_back(i);
    append(vertices, vertices_[i]);
  }
  return {{"moved", moved}, {"vertices_mm", vertices}};
}

Json tool_json(const geometry::Tool& tool) {
  std::size_t triangles = 0;
  for (const geometry::ToolPart& part : tool.parts) triangles += part.mesh.triangles.size();
  check_triangles("tool: the instrument", triangles);
  Json parts = Json::array();
  for (const geometry::ToolPart& part : tool.parts) {
    Json json = mesh_json(part.mesh);
    if (part.is_jaw) {
      json["pivot_mm"] = list(part.pivot / kMillimetre);
      json["axis"] = list(part.axis);
      json["open_deg"] = part.open_angle * 180.0 / std::numbers::pi;
    }
    parts.push_back(std::move(json));
  }
  return {{"name", tool.name}, {"parts", parts}};
}

Json picture_json(const haptics::Snapshot& snapshot) {
  Json hands = Json::array();
  for (std::size_t hand = 0; hand < snapshot.hand_results().size(); ++hand) {
    const contact::ToolInput& tool = snapshot.tools[hand];
    const contact::ToolResult& result = snapshot.results[hand];
    Json contacts = Json::array();
    for (const contact::ContactView& view :
         std::span(result.views).first(static_cast<std::size_t>(result.view_count))) {
      contacts.push_back({{"point_m", list(view.point_S)},
                          {"direction", list(view.direction_S)},
                          {"depth_m", view.depth},
                          {"tip_radius_m", view.tip_radius},
                          {"half_width_m", view.half_width},
                          {"pull", view.pull}});
    }
    hands.push_back({{"tool_m", list(tool.pose_W.position)},
                     {"tool_wxyz", list(tool.pose_W.rotation)},
                     {"gripper", tool.gripper},
                     {"contacts", contacts}});
  }
  return {{"tick", snapshot.tick},
          {"organ_m", list(snapshot.organ_W.position)},
          {"organ_wxyz", list(snapshot.organ_W.rotation)},
          {"hands", hands}};
}

}  // namespace palpate::net
