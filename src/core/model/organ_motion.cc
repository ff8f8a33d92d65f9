#include "palpate/organ_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/model/require_within.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::model {
namespace {

constexpr double kDegree = portable::kPi / 180.0;  // rad

// of a beat: ejection lasts about 0.29 s at 70 beats per minute [Weissler 1968]
constexpr double kThird = 1.0 / 3.0;

// Largest slopes of the curves, per cycle. Breathing: 6 pi sin^5 cos at sin^2 = 5/6.
constexpr double kBreathingSlope = 4.8784;
constexpr double kStepSlope = 1.875;  // of smooth_step()
constexpr double kHeartbeatSlope = kStepSlope / kThird;

/// Minimum-jerk curve from 0 to 1 (Flash and Hogan 1985): zero speed and acceleration at both ends.
double smooth_step(double u) noexcept { return u * u * u * (10.0 + u * (-15.0 + u * 6.0)); }

/// sin^6(pi u) = ((1 - cos 2 pi u) / 2)^3, u in [0, 1).
double breathing(double u) noexcept {
  const double square = 0.5 * (1.0 - portable::cos_of_turns(u));
  return square * square * square;
}

double heartbeat(double u) noexcept {
  if (u < kThird) return smooth_step(u / kThird);
  if (u < 2.0 * kThird) return smooth_step((2.0 * kThird - u) / kThird);
  return 0.0;
}

void require_unit(const std::string& field, const Vec3& direction) {
  constexpr double kSlack = 1e-9;
  const double norm = direction.norm();
  if (!(std::abs(norm - 1.0) <= kSlack)) throw ParameterError(field, norm, "a vector of length 1");
}

void validate_one(const OrganMotionParameters& motion) {
  require_within("amplitude_mm", motion.amplitude, 0.0, kMaxOrganAmplitude, kMillimetre);
  require_within("rotation_deg", motion.rotation, -kMaxOrganRotation, kMaxOrganRotation, kDegree);
  require_within("period_s", motion.period, kShortestOrganPeriod, kLongestOrganPeriod, 1.0);
  if (!(motion.phase >= 0.0 && motion.phase < 1.0))
    throw ParameterError("phase", motion.phase, ">= 0 and < 1");
  require_unit("direction", motion.direction_W);
  require_unit("axis", motion.axis_W);
}

}  // namespace

OrganMotionParameters organ_motion_preset(OrganMotionKind kind) {
  OrganMotionParameters motion;
  motion.kind = kind;
  if (kind == OrganMotionKind::kBreathing) {
    motion.amplitude = 10e-3;
    motion.period = 4.0;
  } else {
    motion.amplitude = 3e-3;
    motion.rotation = 4.0 * kDegree;
    motion.period = 60.0 / 70.0;
  }
  return motion;
}

const char* to_string(OrganMotionKind kind) noexcept {
  return kind == OrganMotionKind::kBreathing ? "breathing" : "heartbeat";
}

OrganSpeed greatest_speed(const OrganMotionParameters& motion) noexcept {
  double slope = motion.kind == OrganMotionKind::kBreathing ? kBreathingSlope : kHeartbeatSlope;
  if (motion.phase > 0.0) slope += kStepSlope;  // while it grows; product rule, the curves are at most 1
  return {slope * motion.amplitude / motion.period, slope * std::abs(motion.rotation) / motion.period};
}

void validate(std::span<const OrganMotionParameters> motions) {
  if (motions.size() > kMaxOrganMotions) {
    throw InputError(std::to_string(motions.size()) + " motions of one organ: must be at most " +
                     std::to_string(kMaxOrganMotions));
  }
  OrganSpeed together;
  for (const OrganMotionParameters& motion : motions) {
    validate_one(motion);
    const OrganSpeed speed = greatest_speed(motion);
    together.translation += speed.translation;
    together.turning += speed.turning;
    if (together.translation < kFastestOrgan && together.turning < kFastestOrganTurn) continue;
    throw ParameterError("period_s", motion.period,
                         "so long, or amplitude_mm and rotation_deg so small, that the organ stays below " +
                             shortest(kFastestOrgan) + " m/s and " + shortest(kFastestOrganTurn) +
                             " rad/s; it would reach " +
                             shortest(std::round(together.translation * 1e3) / 1e3) + " m/s and " +
                             shortest(std::round(together.turning * 1e3) / 1e3) + " rad/s");
  }
}

double share_of_way(const OrganMotionParameters& motion, double cycles) noexcept {
  const double turned = cycles + motion.phase;
  const double u = turned - std::floor(turned);
  const double way = motion.kind == OrganMotionKind::kBreathing ? breathing(u) : heartbeat(u);
  if (motion.phase == 0.0 || cycles >= 1.0) return way;
  return smooth_step(std::max(0.0, cycles)) * way;
}

OrganMotion::OrganMotion(std::vector<OrganMotionParameters> motions, const Vec3& middle_S)
    : motions_(std::move(motions)), middle_S_(middle_S) {
  validate(motions_);
}

Pose OrganMotion::pose_at(const Pose& rest_W, std::uint64_t tick, double rate_Hz) const noexcept {
  if (!moves() || tick == 0) return rest_W;
  const Vec3 middle_W = rest_W * middle_S_;
  Vec3 moved = Vec3::Zero();
  Quat turned = Quat::Identity();
  for (const OrganMotionParameters& motion : motions_) {
    const double share = share_of_way(motion, static_cast<double>(tick) / (rate_Hz * motion.period));
    moved += motion.amplitude * share * motion.direction_W;
    if (motion.rotation != 0.0) turned = rotation_about(motion.axis_W, motion.rotation * share) * turned;
  }
  return {turned * rest_W.rotation, middle_W + moved + turned * (rest_W.position - middle_W)};
}

}  // namespace palpate::model
