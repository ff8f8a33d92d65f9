#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "palpate/pose.h"
#include "palpate/tool.h"

namespace palpate::contact {

enum class Phase : std::uint8_t { kApproach, kPress, kPull, kInsert };
/// As recordings, messages and Python name them.
inline constexpr std::array kPhaseNames{"approach", "press", "pull", "insert"};

/// Bits of ToolResult::status.
inline constexpr std::uint32_t kStartedInside = 1U << 0;  // a part gives no force until it has left the organ
inline constexpr std::uint32_t kContactsFull = 1U << 1;   // a part has more contacts than kContactsPerPart
inline constexpr std::uint32_t kGripReleased = 1U << 2;   // above the grip limit: the grasp let go
inline constexpr std::uint32_t kJump = 1U << 3;  // the tool moved faster than any hand: contact starts again
inline constexpr std::uint32_t kExtrapolated = 1U << 4;  // deeper than the tissue's max_depth: the force goes
                                                         // on by its tangent there
inline constexpr std::uint32_t kAtHub = 1U << 5;         // a needle is in up to its hub, which pushes

inline constexpr int kContactsPerPart = 4;
inline constexpr int kMaxViews = kContactsPerPart * static_cast<int>(kMaxParts) + 1;

/// One contact, for drawing. Organ frame S.
struct ContactView {
  Vec3 point_S = Vec3::Zero();  // on the rest surface
  Vec3 direction_S =
      Vec3::Zero();            // unit, displacement of the surface: inwards (press), towards the tool (pull)
  double depth = 0.0;          // D [m]; smaller while the contact fades
  double tip_radius = 0.0;     // R of the tool at the contact [m]
  double half_width = 0.0;     // of the tool at the contact [m]; 0: no bound
  std::int32_t triangle = -1;  // index in the refined rest surface; -1: none
  bool pull = false;
  double force = 0.0;  // of the tissue on the tool, out of the surface [N]; negative in a pull; 0: a needle

  /// [rt] Radius of the dent's tip [m].
  [[nodiscard]] double radius() const noexcept {
    return half_width > 0.0 ? std::min(tip_radius, half_width) : tip_radius;
  }
};

/// Pose and jaw opening of one tool at one tick.
struct ToolInput {
  Pose pose_W;           // of the handle, world frame
  double gripper = 0.0;  // 0 closed .. 1 open
};

/// A needle in the tissue at one tick.
struct InsertedNeedle {
  std::uint32_t layer = 0;  // of the tip, from 1; 0: not in a layer
  double length = 0.0;      // of the shaft past its entry, also out of the far side [m]
  int slip = 0;             // 1: the shaft slips inwards, -1: outwards, 0: the tissue moves with it
  double tip_force = 0.0;   // on the tip; the rest is friction on the shaft, or the hub's push [N]
  bool at_hub = false;      // the whole shaft is inside
  bool punctured = false;   // a layer in this tick
  bool left = false;        // the tissue in this tick, as it had come in
};

/// Force of the tissue on one tool at one tick, and the contact. World frame, SI units.
struct ToolResult {
  Phase phase = Phase::kApproach;
  double distance = 0.0;          // [m] approach: tool to organ, negative inside; press: -depth; grasp: 0
  Vec3 nearest_W = Vec3::Zero();  // [m] approach: organ's point nearest to the tool; else contact_W
  Vec3 away_W = Vec3::UnitZ();    // unit vector from the tissue to the tool; in contact the contact normal
  Vec3 force_W = Vec3::Zero();    // on the hand, with friction, before the gate [N]
  Vec3 torque_W = Vec3::Zero();   // about the handle's origin [N m]
  double friction = 0.0;          // norm of the tangential force [N]
  // Values of the contact with the largest force. Without contact they are 0, and contact_W is the nearest
  // point.
  double depth = 0.0;    // D, or the stretch in a pull [m]
  int cutoff_layer = 0;  // 0 without contact
  bool saturated = false;
  Vec3 contact_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();
  std::uint32_t status = 0;
  InsertedNeedle needle;
  int view_count = 0;
  std::array<ContactView, kMaxViews> views{};
};

}  // namespace palpate::contact
