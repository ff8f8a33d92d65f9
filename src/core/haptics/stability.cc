#include "core/haptics/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/text.h"
#include "palpate/spring_law.h"

namespace palpate::haptics {
namespace {

constexpr int kDepths = 1500;

/// The largest tangent stiffness [N/m] from the surface down to the deepest depth within reach.
double largest_tangent(const model::SpringLaw& law, double max_force) {
  const double deepest =
      std::min({kDepthWithinReach, law.max_depth(), law.deformation_under(max_force).depth});
  double largest = law.force_at(0.0).stiffness;
  for (int i = 1; i <= kDepths; ++i) {
    largest = std::max(largest, law.force_at(deepest * i / kDepths).stiffness);
  }
  return largest;
}

std::string rounded(double value) {
  constexpr double kThreeDigits = 1000.0;
  return shortest(std::round(value * kThreeDigits) / kThreeDigits);
}

}  // namespace

StabilityCheck check_stability(const model::TissueParameters& tissue, model::Direction direction,
                               double period, double max_force, double scale, const DeviceMechanics& device,
                               double variation) {
  const model::SpringLaw law(tissue, direction, period);
  StabilityCheck check;
  const double along_surface = tissue.contact.friction > 0.0 ? tissue.tangential_stiffness() : 0.0;
  check.stiffness = scale * std::max(variation * largest_tangent(law, max_force), along_surface);
  // Normal direction: K and B. Along the surface: k_t and c_t. Each axis is a virtual wall of its own
  // [Colgate, Schenkel 1997]; the larger values cover both.
  check.virtual_damping = scale * std::max(tissue.contact.damping, tissue.contact.tangential_damping);
  check.damping_needed = check.stiffness * period / 2.0 + std::abs(check.virtual_damping);
  check.stiffness_allowed = device.resolution > 0.0 ? 2.0 * device.friction / device.resolution
                                                    : std::numeric_limits<double>::infinity();
  check.damping_short = device.damping < check.damping_needed;
  check.friction_short = check.stiffness > check.stiffness_allowed;
  return check;
}

double stiffness_ratio_of(const model::TissueParameters& tissue, model::Direction direction, double period,
                          const model::Inclusion& inclusion, double depth, double tip_radius) {
  const model::SpringLaw uniform(tissue, direction, period);
  const model::InclusionLaw law(inclusion.radius, depth, inclusion.ratio);
  const auto force_at = [&](double d) {
    const model::InclusionLaw::Extra extra = law.at(model::PressedTip(tip_radius, d), 0.0);
    return uniform.force_at(d).force * (1.0 + extra.energy) + uniform.energy_at(d) * extra.by_depth;
  };
  constexpr int kSteps = 150;
  constexpr double kStep = kDepthWithinReach / kSteps;
  double largest = 1.0;
  for (int i = 0; i < kSteps; ++i) {
    const double low = kStep * i;
    const double plain = uniform.force_at(low + kStep).force - uniform.force_at(low).force;
    if (plain > 0.0) largest = std::max(largest, (force_at(low + kStep) - force_at(low)) / plain);
  }
  return largest;
}

double depth_of_tangent(const model::TissueParameters& tissue, model::Direction direction, double period,
                        double stiffness) {
  const model::SpringLaw law(tissue, direction, period);
  for (int i = 0; i <= kDepths; ++i) {
    const double depth = kDepthWithinReach * i / kDepths;
    if (law.force_at(depth).stiffness > stiffness) return depth;
  }
  return std::numeric_limits<double>::infinity();
}

std::vector<std::string> stability_warnings(const StabilityCheck& check, const DeviceMechanics& device) {
  std::vector<std::string> warnings;
  if (check.damping_short) {
    warnings.push_back("the device may tremble: its damping, " + rounded(device.damping) +
                       " N s/m, is less than this tissue needs at this rate, " +
                       rounded(check.damping_needed) +
                       " N s/m (K T/2 + B with K = " + rounded(check.stiffness) +
                       " N/m); a faster loop, a softer tissue, less contact damping or "
                       "a smaller workspace_scale help");
  }
  if (check.friction_short) {
    warnings.push_back("the device may buzz: the tissue's stiffness, " + rounded(check.stiffness) +
                       " N/m, is more than its friction and sensors allow, " +
                       rounded(check.stiffness_allowed) +
                       " N/m (2 f_c / resolution); a softer tissue or a smaller workspace_scale help");
  }
  return warnings;
}

}  // namespace palpate::haptics
