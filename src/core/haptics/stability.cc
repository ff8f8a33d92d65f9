#include "core/haptics/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "core/contact/largest_stiffness.h"
#include "core/haptics/passivity.h"

namespace palpate::haptics {
namespace {

/// Whether a free mass oscillates in the sampled loop. State: position and speed now, position a tick ago.
/// The force of a tick is -K x - B (x - x_before) / T, held for the tick; the device's damping acts all the
/// time.
bool oscillates(double stiffness, double virtual_damping, const DeviceMechanics& device, double period) {
  const double rate = device.damping / device.mass;  // 1/s
  const double kept = portable::exp(-rate * period);
  const double way = rate > 0.0 ? (1.0 - kept) / rate : period;  // s: position by speed
  const double speed_by_force = way / device.mass;               // m/s by N
  const double way_by_force =                                    // m by N
      rate > 0.0 ? (period - way) / device.damping : 0.5 * period * period / device.mass;
  const Eigen::RowVector3d force(-stiffness - virtual_damping / period, 0.0, virtual_damping / period);
  Eigen::Matrix3d step;
  step << 1.0, way, 0.0, 0.0, kept, 0.0, 1.0, 0.0, 0.0;
  step.row(0) += way_by_force * force;
  step.row(1) += speed_by_force * force;
  return !(step.eigenvalues().cwiseAbs().maxCoeff() < 1.0);
}

std::string rounded(double value) {
  constexpr double kThreeDigits = 1000.0;
  return shortest(std::round(value * kThreeDigits) / kThreeDigits);
}

}  // namespace

StabilityCheck check_stability(const model::TissueParameters& tissue, const StabilityLoop& loop,
                               const DeviceMechanics& device) {
  const model::SpringLaw law(tissue, loop.direction, loop.period);
  StabilityCheck check;
  const double along_surface = tissue.contact.friction > 0.0 ? tissue.tangential_stiffness() : 0.0;
  const double tangent = contact::largest_tangent(law, {loop.direction, loop.max_force, kDepthWithinReach});
  check.stiffness = loop.scale * std::max(loop.variation * tangent, along_surface);
  // Normal direction: K and B. Along the surface: k_t and c_t. Each axis is a virtual wall of its own
  // [Colgate, Schenkel 1997]; the larger values cover both.
  check.virtual_damping = loop.scale * std::max(tissue.contact.damping, tissue.contact.tangential_damping);
  check.damping_needed = check.stiffness * loop.period / 2.0 + std::abs(check.virtual_damping);
  check.stiffness_allowed = device.resolution > 0.0 ? 2.0 * device.friction / device.resolution
                                                    : std::numeric_limits<double>::infinity();
  check.stiffness_by_slew = loop.slew / (2.0 * kReserveSpeed);
  check.damping_short = device.damping < check.damping_needed;
  check.friction_short = check.stiffness > check.stiffness_allowed;
  check.mass_short = device.mass > 0.0 &&
                     oscillates(check.stiffness, check.virtual_damping + kMaxDamping, device, loop.period);
  check.slew_short = check.stiffness > check.stiffness_by_slew;
  return check;
}

double depth_of_tangent(const model::TissueParameters& tissue, model::Direction direction, double period,
                        double stiffness) {
  const model::SpringLaw law(tissue, direction, period);
  const auto exceeds = [&](double depth) {
    const model::ContactResponse response = law.force_at(depth);
    return response.saturated || response.stiffness > stiffness;
  };
  if (exceeds(0.0)) return 0.0;
  const double reach = std::numeric_limits<double>::max();
  if (!(contact::largest_tangent(law, {direction, reach, kDepthWithinReach}) > stiffness)) {
    return std::numeric_limits<double>::infinity();
  }
  // Both laws stiffen with depth.
  constexpr int kHalvings = 60;
  double low = 0.0;
  double high = kDepthWithinReach;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (exceeds(middle) ? high : low) = middle;
  }
  return high;
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
  if (check.mass_short) {
    warnings.push_back("the device may buzz: its mass, " + rounded(device.mass) +
                       " kg, is too small for this tissue, " + rounded(check.stiffness) +
                       " N/m, at this rate; a faster loop or a softer tissue help");
  }
  const std::string note = slew_note(check);
  if (!note.empty()) warnings.push_back(note);
  return warnings;
}

std::string slew_note(const StabilityCheck& check) {
  if (!check.slew_short) return {};
  return "the slew limit lets the hand feel at most " + rounded(check.stiffness_by_slew) +
         " N/m of the tissue's " + rounded(check.stiffness) +
         " N/m, because a force must fall before it gives energy; a larger max_slew_N_per_ms helps";
}

}  // namespace palpate::haptics
