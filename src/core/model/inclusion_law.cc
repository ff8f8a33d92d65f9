#include <cmath>

#include "core/base/portable_math.h"
#include "core/model/require_within.h"
#include "palpate/inclusion.h"
#include "palpate/organ_motion.h"
#include "palpate/units.h"

namespace palpate::model {
namespace {

// Shape constants of the law, fitted by tools/update_lump_references.
constexpr double kStrength = 2.3;        // A
constexpr double kRise = 0.6;            // b
constexpr double kReach = 1.4;           // k
constexpr double kBound = 0.45;          // beta
constexpr double kNear = 0.4;            // eta
constexpr double kFlattening = 0.45;     // omega
constexpr double kWidthByDepth = 0.88;   // kappa_1
constexpr double kWidthByContact = 2.3;  // kappa_2
constexpr double kNarrowing = 0.18;      // zeta

}  // namespace

std::span<const InclusionPreset> inclusion_presets() {
  constexpr double kBeat = 60.0 / 70.0;  // s
  static const InclusionPreset kPresets[] = {
      {"nodule", {Vec3::Zero(), 5e-3, 10.0, 0.0, kBeat}, 10e-3},
      {"stone", {Vec3::Zero(), 5e-3, 100.0, 0.0, kBeat}, 8e-3},
      {"plaque", {Vec3::Zero(), 3e-3, 30.0, 0.0, kBeat}, 5e-3},
      {"vessel", {Vec3::Zero(), 3e-3, 3.0, 1e-3, kBeat}, 6e-3},
      {"cyst", {Vec3::Zero(), 6e-3, 0.1, 0.0, kBeat}, 9e-3},
  };
  return kPresets;
}

void validate(const Inclusion& inclusion) {
  require_within("radius_mm", inclusion.radius, kSmallestInclusion, kLargestInclusion, kMillimetre);
  require_within("stiffness_ratio", inclusion.ratio, kSoftestInclusion, kStiffestInclusion, 1.0);
  require_within("pulse_mm", inclusion.pulse, 0.0, kLargestInclusion, kMillimetre);
  require_within("pulse_period_s", inclusion.pulse_period, kShortestOrganPeriod, kLongestOrganPeriod, 1.0);
}

void validate(const StiffnessPoint& point, const std::string& field) {
  if (!point.point_S.allFinite()) throw InputError(field + ": its point must be finite");
  require_within(field, point.factor, kSmallestFactor, kLargestFactor, 1.0);
}

PressedTip::PressedTip(double tip_radius, double depth) noexcept {
  if (!(depth > 0.0)) return;
  const double ratio = depth / tip_radius;
  const double flattened = 1.0 / std::sqrt(1.0 + kFlattening * ratio * ratio);
  square = tip_radius * depth * flattened;
  by_depth = tip_radius * flattened * flattened * flattened;
  radius = std::sqrt(square);
  log_slope = 0.5 * flattened * flattened / depth;
}

InclusionLaw::InclusionLaw(double radius, double depth, double ratio) noexcept
    : strength_(kStrength * radius * radius * radius),
      depth_(depth * depth - kRise * radius * radius),
      contrast_(ratio - 1.0) {
  const double share = radius / depth;
  const double cubed = share * share * share;
  bound_ = 1.0 + kBound * (1.0 + kNear * cubed) * contrast_;
  const double narrowed = 1.0 - kNarrowing * cubed * contrast_ / bound_;
  width_ = narrowed * kWidthByDepth * depth * depth;
  width_by_contact_ = narrowed * kWidthByContact;
}

InclusionLaw::Extra InclusionLaw::at(const PressedTip& tip, double square) const noexcept {
  const double inverse = 1.0 / (depth_ + kReach * tip.square);
  const double x = strength_ * tip.radius * inverse * inverse;
  const double x_by_depth = x * (tip.log_slope - 2.0 * kReach * inverse * tip.by_depth);
  const double whole = 1.0 / (bound_ + x);
  const double gamma = contrast_ * x * whole;
  const double gamma_by_depth = contrast_ * bound_ * whole * whole * x_by_depth;
  const double width = width_ + width_by_contact_ * tip.square;
  const double far = 1.0 / (width + square);
  const double v = width * far;
  const double g = v * v * v;
  const double g_by_depth = 3.0 * v * v * square * far * far * width_by_contact_ * tip.by_depth;
  return {gamma * g, gamma_by_depth * g + gamma * g_by_depth, -3.0 * gamma * g * far};
}

CappedFactor cap_factor(double product) noexcept {
  if (!(product > kUncappedFactor)) return {product, 1.0};
  constexpr double kRoom = kLargestEnergyFactor - kUncappedFactor;
  const double decay = portable::exp(-2.0 * (product - kUncappedFactor) / kRoom);
  const double tanh = (1.0 - decay) / (1.0 + decay);
  return {kUncappedFactor + kRoom * tanh, 1.0 - tanh * tanh};
}

}  // namespace palpate::model
