#include "palpate/tool.h"

namespace palpate::geometry {

Pose part_pose(const ToolPart& part, double gripper) noexcept {
  if (!part.is_jaw) return {};
  const Quat turn = rotation_about(part.axis, gripper * part.open_angle);
  return {turn, part.pivot - turn * part.pivot};
}

}  // namespace palpate::geometry
