#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "palpate/pose.h"

namespace palpate::model {

/// Waveform of an organ motion over one cycle, u = 0..1. Breathing is sin^6(pi u): slow at the end of
/// expiration, fast at the end of inspiration. This is the cos^2n curve with n = 3 of [Lujan 1999;
/// Seppenwoolde 2002]. Heartbeat rises in the first third (systole), falls in the second and rests in the
/// last; rise and fall are minimum-jerk polynomials.
enum class OrganMotionKind { kBreathing, kHeartbeat };

/// One periodic rigid motion of an organ. The organ moves from its rest pose by `amplitude` along
/// `direction_W` and back. At the same time it rotates by `rotation` about `axis_W`. SI units, world frame.
struct OrganMotionParameters {
  OrganMotionKind kind = OrganMotionKind::kBreathing;
  double amplitude = 0.0;            // m, from rest to peak, >= 0
  Vec3 direction_W = Vec3::UnitZ();  // unit
  double rotation = 0.0;             // rad, about the centre of the organ's bounding box
  Vec3 axis_W = Vec3::UnitZ();       // unit
  double period = 4.0;               // s
  double phase = 0.0;                // position in the cycle at tick 0, in [0, 1)
};

inline constexpr std::size_t kMaxOrganMotions = 4;
inline constexpr double kMaxOrganAmplitude = 0.1;                                     // m
inline constexpr double kMaxOrganRotation = 45.0 * (3.14159265358979323846 / 180.0);  // rad
inline constexpr double kShortestOrganPeriod = 0.2;                                   // s: 300 per minute
inline constexpr double kLongestOrganPeriod = 60.0;                                   // s
inline constexpr double kFastestOrgan = 1.0;      // m/s, limit of the speed of all motions together
inline constexpr double kFastestOrganTurn = 5.0;  // rad/s: 1 m/s at 200 mm from the organ's centre

/// [setup] The motion of a resting adult, along and about z. Breathing: 10 mm, 15 per minute. Heartbeat: 3 mm
/// and 4 degrees, 70 per minute. docs/model.md, "Moving organ", lists the sources.
[[nodiscard]] OrganMotionParameters organ_motion_preset(OrganMotionKind kind);

/// [any] "breathing" or "heartbeat".
[[nodiscard]] const char* to_string(OrganMotionKind kind) noexcept;

/// [setup] Checks the fields of every motion, and the speed of all motions together. @throws ParameterError
/// that names the first invalid field by its key in a scene file (amplitude_mm, rotation_deg, period_s,
/// phase), its value in that unit and the valid range; InputError for more than kMaxOrganMotions motions.
void validate(std::span<const OrganMotionParameters> motions);

/// Largest speeds of one motion: translation [m/s] and rotation [rad/s].
struct OrganSpeed {
  double translation = 0.0;
  double turning = 0.0;
};
/// [any] Largest speeds of the motion over its cycle.
[[nodiscard]] OrganSpeed greatest_speed(const OrganMotionParameters& motion) noexcept;

/// [rt] Displacement of a motion as a fraction of its amplitude, 0 (rest) to 1 (peak), `cycles` periods after
/// tick 0. It is twice continuously differentiable; at tick 0 value and speed are 0. When `phase` is not 0,
/// the amplitude rises smoothly from 0 during the first cycle. The motion is periodic afterwards.
[[nodiscard]] double share_of_way(const OrganMotionParameters& motion, double cycles) noexcept;

/// Motion of an organ: the sum of several periodic motions. The pose is a pure function of the tick number.
class OrganMotion final {
 public:
  /// An organ without motion.
  OrganMotion() = default;
  /// [setup] @param middle_S centre of the rotations, organ frame [m] @throws as validate().
  OrganMotion(std::vector<OrganMotionParameters> motions, const Vec3& middle_S);

  [[nodiscard]] bool moves() const noexcept { return !motions_.empty(); }

  /// [rt] Pose of the organ at a tick. It is exactly `rest_W` at tick 0 and for an organ without motion.
  /// Translations are added. Rotations are applied in the order of the motions, about the organ's centre,
  /// which moves with the translations. @param rest_W pose at rest
  [[nodiscard]] Pose pose_at(const Pose& rest_W, std::uint64_t tick, double rate_Hz) const noexcept;

 private:
  std::vector<OrganMotionParameters> motions_;
  Vec3 middle_S_ = Vec3::Zero();
};

}  // namespace palpate::model
