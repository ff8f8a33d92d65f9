#include "core/contact/tool_tissue.h"

#include <algorithm>

namespace palpate::contact {

TissueAt::TissueAt(const ToolTissue& tissue, const SurfacePoint& place) noexcept
    : inclusions_(tissue.inclusions),
      tip_radius_(tissue.tip_radius),
      factor_(tissue.map.factor_at(place)),
      place_S_(place.point) {
  factor_.value *= tissue.size_factor;
  factor_.gradient_S *= tissue.size_factor;
  for (std::size_t j = 0; j < inclusions_.size(); ++j) {
    const InclusionNow& one = inclusions_[j];
    squares_[j] = std::max(0.0, (place_S_ - one.centre_S).squaredNorm() - one.depth_squared);
  }
}

TissueAt::Force TissueAt::force_at(const model::SpringLaw& law, double depth) const noexcept {
  const model::PressedTip tip(tip_radius_, depth);
  double energy = 1.0;
  double by_depth = 0.0;  // of ln energy
  Vec3 by_place = Vec3::Zero();
  for (std::size_t j = 0; j < inclusions_.size(); ++j) {
    const model::InclusionLaw::Extra extra = inclusions_[j].law.at(tip, squares_[j]);
    const double factor = 1.0 + extra.energy;
    energy *= factor;
    by_depth += extra.by_depth / factor;
    by_place += (2.0 * extra.by_square / factor) * (place_S_ - inclusions_[j].centre_S);
  }
  if (energy > model::kUncappedFactor) {
    const model::CappedFactor capped = model::cap_factor(energy);
    const double of_logarithm = capped.slope * energy / capped.value;  // d(ln capped) / d(ln product)
    energy = capped.value;
    by_depth *= of_logarithm;
    by_place *= of_logarithm;
  }
  const model::ContactResponse uniform = law.force_at(depth);
  const double uniform_energy = law.energy_at(depth);
  return {factor_.value * energy * (uniform.force + uniform_energy * by_depth),
          -uniform_energy * energy * (factor_.value * by_place + factor_.gradient_S),
          factor_.value * energy * (uniform.stiffness + 2.0 * uniform.force * by_depth), uniform};
}

Vec3 TissueAt::follow(const model::SpringLaw& law, double normal, double& depth) const noexcept {
  const Force here = force_at(law, depth);
  depth = normal > 0.0 && here.slope > 0.0
              ? std::clamp(depth + (normal - here.normal) / here.slope, 0.0, law.max_depth())
              : 0.0;
  return here.lateral_S;
}

}  // namespace palpate::contact
