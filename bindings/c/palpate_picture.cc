// Functions of palpate.h for display: the organ's surface and the instruments.
#include <cstddef>
#include <span>
#include <string>

#include "palpate/tool.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/c/struct_size.h"

using palpate::c_interface::give;
using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::require_size;
using palpate::c_interface::require_usable;
using palpate::c_interface::UseError;

namespace {

/// @throws UseError if a caller's array has no space for `wanted` entries.
void require_capacity(std::size_t capacity, std::size_t wanted, const char* what) {
  if (capacity >= wanted) return;
  throw UseError("capacity = " + std::to_string(capacity) + ": must be at least the " +
                 std::to_string(wanted) + " " + what);
}

void copy_vertices(std::span<const palpate::Vec3> vertices, double* xyz, std::size_t capacity) {
  require_given(xyz, "xyz");
  require_capacity(capacity, vertices.size(), "vertices");
  for (const palpate::Vec3& vertex : vertices) {
    *xyz++ = vertex.x();
    *xyz++ = vertex.y();
    *xyz++ = vertex.z();
  }
}

void copy_triangles(std::span<const palpate::geometry::Triangle> triangles, std::int32_t* corners,
                    std::size_t capacity) {
  require_given(corners, "corners");
  require_capacity(capacity, triangles.size(), "triangles");
  for (const palpate::geometry::Triangle& triangle : triangles) {
    for (const std::int32_t corner : triangle) *corners++ = corner;
  }
}

/// @throws UseError if the part does not exist.
const palpate::geometry::ToolPart& part_of(const palpate_simulation* simulation, std::uint32_t hand,
                                           std::uint32_t part) {
  require_usable(simulation);
  const auto& tools = simulation->scene().tools;
  if (hand >= tools.size()) {
    throw UseError("hand = " + std::to_string(hand) + ": must be less than the " +
                   std::to_string(tools.size()) + " hands");
  }
  const auto& parts = tools[hand].parts;
  if (part >= parts.size()) {
    throw UseError("part = " + std::to_string(part) + ": must be less than the instrument's " +
                   std::to_string(parts.size()) + " parts");
  }
  return parts[part];
}

}  // namespace

extern "C" {

palpate_status palpate_surface_update(palpate_simulation* simulation, palpate_picture* picture) {
  return guarded([&] {
    require_usable(simulation);
    require_given(picture, "picture");
    require_size(*picture, "palpate_picture");
    palpate_picture whole{};
    simulation->update_surface(whole);
    give(whole, picture);
  });
}

palpate_status palpate_surface_vertices(const palpate_simulation* simulation, double* xyz, size_t capacity) {
  return guarded([&] {
    require_usable(simulation);
    copy_vertices(simulation->vertices(), xyz, capacity);
  });
}

palpate_status palpate_surface_triangles(const palpate_simulation* simulation, int32_t* corners,
                                         size_t capacity) {
  return guarded([&] {
    require_usable(simulation);
    copy_triangles(simulation->rest_surface().triangles, corners, capacity);
  });
}

palpate_status palpate_tool_part(const palpate_simulation* simulation, uint32_t hand, uint32_t part,
                                 palpate_part* info) {
  return guarded([&] {
    const palpate::geometry::ToolPart& found = part_of(simulation, hand, part);
    require_given(info, "info");
    require_size(*info, "palpate_part");
    palpate_part whole{};
    whole.name = found.name.c_str();
    whole.vertices = found.mesh.vertices.size();
    whole.triangles = found.mesh.triangles.size();
    whole.is_jaw = found.is_jaw ? 1 : 0;
    give(whole, info);
  });
}

palpate_status palpate_part_vertices(const palpate_simulation* simulation, uint32_t hand, uint32_t part,
                                     double* xyz, size_t capacity) {
  return guarded([&] { copy_vertices(part_of(simulation, hand, part).mesh.vertices, xyz, capacity); });
}

palpate_status palpate_part_triangles(const palpate_simulation* simulation, uint32_t hand, uint32_t part,
                                      int32_t* corners, size_t capacity) {
  return guarded([&] { copy_triangles(part_of(simulation, hand, part).mesh.triangles, corners, capacity); });
}

palpate_status palpate_part_pose(const palpate_simulation* simulation, uint32_t hand, uint32_t part,
                                 double gripper, double position[3], double orientation[4]) {
  return guarded([&] {
    const palpate::geometry::ToolPart& found = part_of(simulation, hand, part);
    require_given(position, "position");
    require_given(orientation, "orientation");
    if (!(gripper >= 0.0 && gripper <= 1.0)) {
      throw palpate::ParameterError("gripper", gripper, ">= 0 (closed) and <= 1 (open)");
    }
    const palpate::Pose pose = palpate::geometry::part_pose(found, gripper);
    position[0] = pose.position.x();
    position[1] = pose.position.y();
    position[2] = pose.position.z();
    orientation[0] = pose.rotation.w();
    orientation[1] = pose.rotation.x();
    orientation[2] = pose.rotation.y();
    orientation[3] = pose.rotation.z();
  });
}

}  // extern "C"
