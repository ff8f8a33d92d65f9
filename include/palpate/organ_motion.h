#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::model {

/// Breathing: sin^6(pi u) of the cycle u, slow at the end of breathing out and quick at the top, the cos^2n
/// curve with n = 3 of [Lujan 1999; Seppenwoolde 2002]. Heartbeat: a third of the cycle up (systole), a third
/// down, a third at rest, each piece a minimum-jerk polynomial.
enum class OrganMotionKind { kBreathing, kHeartbeat };

/// One periodic rigid motion of an organ: it moves by `amplitude` along `direction_W` and turns by `rotation`
/// about `axis_W`, both in step, from the rest pose (share 0) to its farthest (share 1) and back. SI, world
/// frame.
struct OrganMotionParameters {
  OrganMotionKind kind = OrganMotionKind::kBreathing;
  double amplitude = 0.0;            // m, from rest to farthest, >= 0
  Vec3 direction_W = Vec3::UnitZ();  // unit
  double rotation = 0.0;             // rad, about the organ's middle
  Vec3 axis_W = Vec3::UnitZ();       // unit
  double period = 4.0;               // s
  double phase = 0.0;                // share of a cycle that has passed at tick 0, in [0, 1)
};

inline constexpr std::size_t kMaxOrganMotions = 4;
inline constexpr double kMaxOrganAmplitude = 0.1;                                     // m
inline constexpr double kMaxOrganRotation = 45.0 * (3.14159265358979323846 / 180.0);  // rad
inline constexpr double kShortestOrganPeriod = 0.2;                                   // s: 300 a minute
inline constexpr double kLongestOrganPeriod = 60.0;                                   // s
inline constexpr double kFastestOrgan = 1.0;      // m/s, below it: all motions together
inline constexpr double kFastestOrganTurn = 5.0;  // rad/s: 1 m/s at 200 mm from the organ's middle

/// [setup] The motion of a resting adult: breathing 10 mm at 15 a minute, heartbeat 3 mm and 4 degrees at 70
/// a minute, along and about z (docs/model.md, "Moving organ", with the sources).
[[nodiscard]] OrganMotionParameters organ_motion_preset(OrganMotionKind kind);

/// [any] "breathing" or "heartbeat".
[[nodiscard]] const char* to_string(OrganMotionKind kind) noexcept;

/// [setup] Checks all fields, one motion after the other, and how fast they are together. @throws
/// ParameterError naming the first bad field as it stands in a scene file (amplitude_mm, rotation_deg,
/// period_s, phase), its value in that unit and what would be right; InputError when there are too many.
void validate(std::span<const OrganMotionParameters> motions);

/// [any] The most that one motion can reach: speed of its translation [m/s] and of its turning [rad/s].
struct OrganSpeed {
  double translation = 0.0;
  double turning = 0.0;
};
[[nodiscard]] OrganSpeed greatest_speed(const OrganMotionParameters& motion) noexcept;

/// [rt] How far a motion is on its way, 0 (rest) to 1, after `cycles` periods since tick 0. Twice
/// continuously differentiable, 0 at tick 0 without speed; periodic from the start when `phase` is 0,
/// otherwise after the first cycle, in which it grows smoothly from nothing to its full size.
[[nodiscard]] double share_of_way(const OrganMotionParameters& motion, double cycles) noexcept;

/// An organ's motion: any of the above at once. A pure function of the tick's number.
class OrganMotion final {
 public:
  /// An organ that lies still.
  OrganMotion() = default;
  /// [setup] @param middle_S what rotations turn about, organ frame [m]
  /// @throws as validate().
  OrganMotion(std::vector<OrganMotionParameters> motions, const Vec3& middle_S);

  [[nodiscard]] bool moves() const noexcept { return !motions_.empty(); }

  /// [rt] Where the organ is at a tick: exactly `rest_W` when it lies still, and at tick 0. Translations add
  /// up; rotations are applied in the motions' order, about the organ's middle carried along.
  /// @param rest_W pose at rest
  [[nodiscard]] Pose pose_at(const Pose& rest_W, std::uint64_t tick, double rate_Hz) const noexcept;

 private:
  std::vector<OrganMotionParameters> motions_;
  Vec3 middle_S_ = Vec3::Zero();
};

}  // namespace palpate::model
