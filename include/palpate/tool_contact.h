#pragma once
#include <array>
#include <cstdint>

#include "palpate/pose.h"

namespace palpate::contact {

enum class Phase : std::uint8_t { kApproach, kPress, kPull };

/// Bits of ToolResult::status.
inline constexpr std::uint32_t kStartedInside = 1U << 0;  // a part is off until it has been outside
inline constexpr std::uint32_t kContactsFull = 1U << 1;   // more than four contacts wanted on one part
inline constexpr std::uint32_t kGripReleased = 1U << 2;   // past the grip's limit: it has let go
inline constexpr std::uint32_t kJump = 1U << 3;  // moved faster than any hand: treated as placed anew

inline constexpr int kContactsPerPart = 4;
inline constexpr int kMaxParts = 3;
inline constexpr int kMaxViews = kContactsPerPart * kMaxParts + 1;

/// One contact as the picture needs it, in the organ's frame S.
struct ContactView {
  Vec3 point_S = Vec3::Zero();      // on the rest surface
  Vec3 direction_S = Vec3::Zero();  // unit, where the surface goes: inwards (press), towards the tool (pull)
  double depth = 0.0;               // D [m], less while the contact fades
  double tip_radius = 0.0;          // R of the tool there [m]
  double half_width = 0.0;          // of the tool there [m]; 0: no bound
  std::int32_t triangle = -1;       // of the refined rest surface
  bool pull = false;
};

/// What one tool does at one tick.
struct ToolInput {
  Pose pose_W;           // handle
  double gripper = 0.0;  // 0 closed .. 1 open
};

/// What the tissue does to one tool at one tick. World frame, SI.
struct ToolResult {
  Phase phase = Phase::kApproach;
  double distance = 0.0;          // approach: tool to organ [m], negative inside; pressed: -depth; held: 0
  Vec3 nearest_W = Vec3::Zero();  // approach: organ's point nearest to the tool; else contact_W
  Vec3 away_W = Vec3::UnitZ();    // unit: from the tissue to the tool; in contact the contact normal
  Vec3 force_W = Vec3::Zero();    // on the hand, tissue and friction, before the gate [N]
  Vec3 torque_W = Vec3::Zero();   // about the handle's origin [N m]
  double friction = 0.0;          // tangential part of force, norm [N]
  // Of the contact with the largest force (none: 0, and the nearest point):
  double depth = 0.0;    // D, or the stretch when pulled [m]
  int cutoff_layer = 0;  // 0 without contact
  bool saturated = false;
  Vec3 contact_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();
  std::uint32_t status = 0;
  int view_count = 0;
  std::array<ContactView, kMaxViews> views{};
};

}  // namespace palpate::contact
