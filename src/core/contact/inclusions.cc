#include "core/contact/inclusions.h"

#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/organ_motion.h"
#include "palpate/units.h"

namespace palpate::contact {

PlacedInclusion::PlacedInclusion(const OrganSurface& surface, const model::Inclusion& given)
    : inclusion(given) {
  model::validate(given);
  if (!given.centre_S.allFinite()) throw InputError("position_mm: must be finite");
  const geometry::NearestPoint nearest = surface.nearest(given.centre_S, -1);
  depth = -nearest.distance;
  const double needed = given.radius + given.pulse;
  if (!(depth >= needed)) {
    const std::string where = depth > 0.0 ? brief(depth / kMillimetre, 3) + " mm below the surface"
                                          : brief(-depth / kMillimetre, 3) + " mm outside the organ";
    throw InputError("the centre is " + where + ": must be at least " + brief(needed / kMillimetre, 3) +
                     " mm below it, the radius and the pulse");
  }
  outward_S = (nearest.point - given.centre_S) / depth;
}

void InclusionState::add(const PlacedInclusion& placed) {
  placed_[count_++] = placed;
  update(count_ - 1, 0.0);
}

void InclusionState::replace(std::size_t index, const PlacedInclusion& placed) noexcept {
  placed_[index] = placed;
  update(index, 0.0);
}

void InclusionState::move_to(double time) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    if (placed_[i].inclusion.pulse > 0.0) update(i, time);
  }
}

void InclusionState::update(std::size_t index, double time) noexcept {
  const PlacedInclusion& one = placed_[index];
  double rise = 0.0;
  if (one.inclusion.pulse > 0.0) {
    model::OrganMotionParameters beat;
    beat.kind = model::OrganMotionKind::kHeartbeat;
    rise = one.inclusion.pulse * model::share_of_way(beat, time / one.inclusion.pulse_period);
  }
  const double depth = one.depth - rise;
  now_[index] = {one.inclusion.centre_S + rise * one.outward_S, depth * depth,
                 model::InclusionLaw(one.inclusion.radius, depth, one.inclusion.ratio), one.inclusion.radius,
                 one.inclusion.ratio};
}

}  // namespace palpate::contact
