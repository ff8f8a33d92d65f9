#pragma once
#include <cstdint>

#include "palpate/device.h"
#include "palpate/pose.h"

namespace palpate::haptics {

/// How a device's sample becomes the tool's pose: translation scaled, then placed by `base`.
struct WorkspaceMapping {
  double scale = 1.0;
  Pose base;
  std::uint32_t clutch = 0;  // buttons of which any one holds the tool's position still; 0: no clutch
  bool held = false;         // a hand, or an emulated one, holds the device and moves by its force
  bool torque = true;        // the device can give torque; else none is asked of it
  double force_scale = 1.0;  // of the tissue's force and torque on the hand

  /// [rt] Pose of the handle in the world. @param index what the clutch has shifted, in scaled device lengths
  [[nodiscard]] Pose apply(const Vec3& position_D, const Quat& orientation_D,
                           const Vec3& index_D = Vec3::Zero()) const noexcept;
  /// [rt] A command of the world's frame in the device's.
  [[nodiscard]] ForceCommand to_device(const ForceCommand& command_W) const noexcept;
};

/// How far a device moved from one sample to the next: its own lengths, the world's axes.
struct DeviceMotion {
  Vec3 translation = Vec3::Zero();  // m
  Vec3 rotation = Vec3::Zero();     // rad, axis times angle, for the small angles of a tick
};

/// Where a device was, one a hand.
struct DeviceTrack {
  Vec3 position_D = Vec3::Zero();  // of the last good sample
  Quat orientation_D = Quat::Identity();
  Vec3 index_D = Vec3::Zero();  // m, what the clutch has shifted
  bool known = false;           // a good sample was there
  bool clutched = false;        // the clutch was held at it
};

/// Faster than this [m/s] a device was placed anew, not moved by its hand: no work was done on the way.
inline constexpr double kFastestHand = 20.0;

/// [rt] Takes the next good sample. While the clutch is held the tool's position stays (its rotation follows
/// the hand), and goes on from there when it is let go: indexing.
/// @param period s @return how far the device moved
DeviceMotion follow(const WorkspaceMapping& mapping, DeviceTrack& track, const DeviceState& sample,
                    double period) noexcept;

}  // namespace palpate::haptics
