#include "core/contact/tool_tissue.h"

#include <algorithm>
#include <cmath>

namespace palpate::contact {

TissueAt::TissueAt(const ToolTissue& tissue, const SurfacePoint& place) noexcept
    : inclusions_(tissue.inclusions),
      tip_radius_(tissue.tip_radius),
      factor_(tissue.map.factor_at(place)),
      place_S_(place.point) {
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
  const double uniform_energy = law.energy_at(depth);
  return {factor_.value * (law.force_at(depth).force * energy + uniform_energy * energy * by_depth),
          -uniform_energy * energy * (factor_.value * by_place + factor_.gradient_S)};
}

double TissueAt::depth_under(const model::SpringLaw& law, double force, double guess) const noexcept {
  if (force <= 0.0) return 0.0;
  constexpr int kMostSteps = 50;
  constexpr double kClose = 1e-12;  // of the force
  double low = 0.0;
  double high = law.max_depth();
  double depth = std::clamp(guess, low, high);
  for (int step = 0; step < kMostSteps; ++step) {
    const double here = force_at(law, depth).normal;
    const double missing = force - here;
    if (std::abs(missing) <= kClose * force) break;
    (missing > 0.0 ? low : high) = depth;
    if (!(low < high)) break;
    // Newton's step with the slope of the uniform tissue, scaled by the force; bisection where it leaves the
    // bracket.
    const model::ContactResponse uniform = law.force_at(depth);
    const double slope = uniform.force > 0.0 ? uniform.stiffness * here / uniform.force : uniform.stiffness;
    const double next = depth + missing / slope;
    depth = next > low && next < high ? next : 0.5 * (low + high);
  }
  return depth;
}

}  // namespace palpate::contact
