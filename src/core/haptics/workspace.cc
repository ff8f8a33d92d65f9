#include "core/haptics/workspace.h"

#include "core/contact/contact_constants.h"

namespace palpate::haptics {

Pose WorkspaceMapping::apply(const Vec3& position_D, const Quat& orientation_D,
                             const Vec3& index_D) const noexcept {
  return base * Pose{orientation_D.normalized(), scale * position_D + index_D};
}

ForceCommand WorkspaceMapping::to_device(const ForceCommand& command_W) const noexcept {
  const Quat back = base.rotation.conjugate();
  return {back * command_W.force, back * command_W.torque, command_W.gripper_force};
}

DeviceMotion follow(const WorkspaceMapping& mapping, DeviceTrack& track, const DeviceState& sample,
                    double period) noexcept {
  const Quat orientation = sample.orientation_D.normalized();
  DeviceMotion motion;
  const bool clutched = (sample.buttons & mapping.clutch) != 0;
  if (track.has_sample) {
    const Vec3 way_D = sample.position_D - track.position_D;
    if (clutched) track.index_D -= mapping.scale * way_D;
    if (way_D.norm() <= contact::kFastestHand * period) {
      const Quat turn = orientation * track.orientation_D.conjugate();
      const double sign = turn.w() < 0.0 ? -2.0 : 2.0;  // 2 sin(a/2) approximates a
      motion.translation = mapping.base.rotation * way_D;
      motion.rotation = mapping.base.rotation * Vec3(sign * turn.vec());
    }
  }
  track.position_D = sample.position_D;
  track.orientation_D = orientation;
  track.has_sample = true;
  track.clutched = clutched;
  return motion;
}

}  // namespace palpate::haptics
