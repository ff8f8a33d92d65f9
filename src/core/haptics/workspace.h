#pragma once
#include <cstdint>

#include "palpate/device.h"
#include "palpate/pose.h"

namespace palpate::haptics {

/// Maps a device's sample to the tool's pose: the translation is scaled, then `base` is applied.
struct WorkspaceMapping {
  double scale = 1.0;
  Pose base;
  std::uint32_t clutch = 0;  // mask of the buttons that hold the clutch; 0: no clutch
  bool held = false;         // a hand, or an emulated one, holds the device and moves under its force
  bool torque = true;        // the device can display torque
  double force_scale = 1.0;  // gain of the tissue's force and torque

  /// [rt] Pose of the handle in the world. @param index the clutch's offset, in scaled device lengths
  [[nodiscard]] Pose apply(const Vec3& position_D, const Quat& orientation_D,
                           const Vec3& index_D = Vec3::Zero()) const noexcept;
  /// [rt] Rotates a command from the world's frame to the device's.
  [[nodiscard]] ForceCommand to_device(const ForceCommand& command_W) const noexcept;
};

/// Motion of a device between two samples: in the device's lengths, along the world's axes.
struct DeviceMotion {
  Vec3 translation = Vec3::Zero();  // m
  Vec3 rotation = Vec3::Zero();     // rotation vector [rad], exact for the small angles of a tick
};

/// The last sample of a device, one per hand.
struct DeviceTrack {
  Vec3 position_D = Vec3::Zero();  // of the last valid sample
  Quat orientation_D = Quat::Identity();
  Vec3 index_D = Vec3::Zero();  // m, the clutch's offset
  bool has_sample = false;      // a valid sample was received
  bool clutched = false;        // the clutch was held in that sample
};

/// [rt] Processes the next valid sample. A device faster than contact::kFastestHand has jumped: its motion
/// counts as zero and does no work. While the clutch is held the tool's position stays and its rotation
/// follows the hand; after release the position continues from there (indexing).
/// @param period T [s] @return the device's motion
DeviceMotion follow(const WorkspaceMapping& mapping, DeviceTrack& track, const DeviceState& sample,
                    double period) noexcept;

}  // namespace palpate::haptics
