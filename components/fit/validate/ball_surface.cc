#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "palpate/validate.h"

namespace palpate::validate {
namespace {

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

/// Height of a ball's surface above its lowest point, at a distance from its axis.
double sag(double radius, double aside) noexcept {
  return radius - std::sqrt(std::max(0.0, radius * radius - aside * aside));
}

}  // namespace

BallSurface::BallSurface(const model::FalloffRatios& reach, double depth, double radius,
                         const SurfaceRule& rule) noexcept
    : profile_(reach, depth, radius, rule.as_drawn ? 0.0 : radius),
      depth_(depth),
      radius_(radius),
      rule_(rule) {}

double BallSurface::at(double r) const noexcept {
  const double u = profile_.at(r);
  if (!rule_.as_drawn || !(depth_ > 0.0)) return u;
  const double rest = rule_.rest_radius;
  // Beyond a quarter turn the rest surface faces away from the ball, which does not displace it there.
  if (rest > 0.0 && r >= kQuarterTurn * rest) return u;
  const double aside = rest > 0.0 ? rest * portable::sin_cos(r / rest).sine : r;  // r is an arc length
  if (!(aside < radius_)) return u;
  const double behind = rest > 0.0 ? sag(rest, aside) : 0.0;  // depth of the rest surface below its top
  return std::max(u, depth_ - sag(radius_, aside) - behind);
}

}  // namespace palpate::validate
