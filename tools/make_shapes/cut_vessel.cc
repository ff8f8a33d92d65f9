#include "tools/make_shapes/cut_vessel.h"

namespace palpate::geometry {

namespace {

constexpr double kLumen = 0.62;  // of the lumen, relative to the outer radius
constexpr double kDepth = 0.45;

}  // namespace

CutVessel::CutVessel(const std::vector<TubeKnot>& knots, double far) : tube_(knots, far), end_(tube_.end()) {
  out_ = tube_.end_direction();
}

FieldValue CutVessel::at(const Vec3& p) const noexcept {
  FieldValue tube = tube_.at(p);
  if (tube.value > 2.0 * end_.radius) return tube;
  return intersect(tube, {(p - end_.middle).dot(out_), out_}, kRim);
}

Ellipsoid CutVessel::lumen() const {
  const double width = kLumen * end_.radius;
  const Vec3 across = out_.cross(Vec3(0.36, 0.48, 0.8));
  return ellipsoid(end_.middle, {kDepth * end_.radius, width, width}, out_, across);
}

}  // namespace palpate::geometry
