#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/model/require_within.h"
#include "palpate/inclusion.h"
#include "palpate/organ_motion.h"
#include "palpate/units.h"

namespace palpate::model {
namespace {

// Shape constants of the law, fitted by tools/update_lump_references.
constexpr double kStrength = 2.32;        // A
constexpr double kReach = 1.38;           // k
constexpr double kBound = 0.445;          // beta
constexpr double kNear = 0.4;             // eta
constexpr double kFlattening = 0.45;      // omega
constexpr double kWidthByDepth = 0.855;   // kappa_1
constexpr double kWidthByContact = 2.47;  // kappa_2
constexpr double kNarrowing = 0.165;      // zeta
// The least h^2 - a^2, in a^2: of a cover of 1 % of the radius.
constexpr double kThinnestCover = 0.02;

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
      cover_(std::max(depth * depth - radius * radius, kThinnestCover * radius * radius)),
      depth_(depth * depth),
      contrast_(ratio - 1.0) {
  const double share = radius / depth;
  const double cubed = share * share * share;
  bound_ = 1.0 + kBound * (1.0 + kNear * cubed) * contrast_;
  const double narrowed = 1.0 - kNarrowing * cubed * contrast_ / bound_;
  width_ = narrowed * kWidthByDepth * depth * depth;
  width_by_contact_ = narrowed * kWidthByContact;
}

InclusionLaw::Extra InclusionLaw::at(const PressedTip& tip, double square) const noexcept {
  const double reach = kReach * tip.square;
  const double cover = cover_ + reach;
  const double depth = depth_ + reach;
  const double inverse = 1.0 / (cover * depth);
  const double x = strength_ * tip.radius * inverse;
  const double x_by_depth = x * (tip.log_slope - kReach * tip.by_depth * (cover + depth) * inverse);
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

InclusionLaw::Slopes InclusionLaw::slopes(const PressedTip& tip, double square, const PressedTip& deeper,
                                          const std::array<InclusionLaw, 3>& others) const noexcept {
  const double cover = 1.0 / (cover_ + kReach * tip.square);
  const double deep = 1.0 / (depth_ + kReach * tip.square);
  const double x_by_strength = tip.radius * cover * deep;
  const double x = strength_ * x_by_strength;
  const double fall = kReach * (cover + deep);
  const double x_rise = tip.log_slope - fall * tip.by_depth;  // d(ln X)/dD
  const double whole = 1.0 / (bound_ + x);
  const double gamma_rise = bound_ * whole * x_rise;  // d(ln gamma)/dD
  const double width = width_ + width_by_contact_ * tip.square;
  const double width_by_depth = width_by_contact_ * tip.by_depth;
  const double far = 1.0 / (width + square);
  const double narrow = 1.0 / width;
  const double g_by_width = 3.0 * square * narrow * far;  // d(ln g)/d(w^2)
  const double v = width * far;
  const double g = v * v * v;
  const double shape = x * whole * g;  // e / (m - 1)
  const double energy = contrast_ * shape;
  const double rise = gamma_rise + g_by_width * width_by_depth;  // d(ln e)/dD
  Slopes made;
  made.here = {energy, energy * rise, -3.0 * energy * far};
  made.by_depth_and_square = made.here.by_square * rise + 3.0 * energy * width_by_depth * far * far;
  const auto changed = [&](double contrast, double bound, double x_more, double x_rise_more, double wider,
                           double wider_by_depth) {
    const double energy_more =
        (contrast * x * whole + contrast_ * whole * whole * (bound_ * x_more - x * bound)) * g +
        energy * g_by_width * wider;
    const double rise_more = whole * (bound * x_rise + bound_ * x_rise_more - gamma_rise * (bound + x_more)) +
                             g_by_width * (wider_by_depth - width_by_depth * wider * (narrow + far));
    return Extra{energy_more, energy_more * rise + energy * rise_more};
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    const InclusionLaw& other = others[i];
    const double cover_more = cover * (other.cover_ - cover_);
    const double depth_more = deep * (other.depth_ - depth_);
    const double widening = other.width_by_contact_ - width_by_contact_;
    made.by_law[i] = changed(other.contrast_ - contrast_, other.bound_ - bound_,
                             (other.strength_ - strength_) * x_by_strength - x * (cover_more + depth_more),
                             kReach * tip.by_depth * (cover * cover_more + deep * depth_more),
                             other.width_ - width_ + widening * tip.square, widening * tip.by_depth);
  }
  const double square_more = deeper.square - tip.square;
  const double by_depth_more = deeper.by_depth - tip.by_depth;
  made.by_depth_twice =
      changed(0.0, 0.0, x * ((deeper.radius - tip.radius) / tip.radius - fall * square_more),
              deeper.log_slope - tip.log_slope - fall * by_depth_more +
                  kReach * kReach * (cover * cover + deep * deep) * square_more * tip.by_depth,
              width_by_contact_ * square_more, width_by_contact_ * by_depth_more)
          .by_depth;
  return made;
}

CappedFactor cap_factor(double product) noexcept {
  if (!(product > kUncappedFactor)) return {product, 1.0};
  constexpr double kRoom = kLargestEnergyFactor - kUncappedFactor;
  const double decay = portable::exp(-2.0 * (product - kUncappedFactor) / kRoom);
  const double tanh = (1.0 - decay) / (1.0 + decay);
  return {kUncappedFactor + kRoom * tanh, 1.0 - tanh * tanh};
}

}  // namespace palpate::model
