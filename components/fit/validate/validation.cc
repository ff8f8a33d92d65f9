#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"
#include "palpate/validate.h"

#include "fit/identify/forward.h"

namespace palpate::validate {
namespace {

/// Calls `ask` with the law that the tissue has.
template <typename Ask>
auto with_law(const Law& law, const Ask& ask) {
  if (law.tissue.law == model::LawKind::kSmooth) {
    return ask(model::SmoothSpringLaw(law.tissue, law.direction, law.period));
  }
  return ask(model::LayeredSpringLaw(law.tissue, law.direction, law.period));
}

}  // namespace

Errors errors_of(const std::vector<double>& measured, const std::vector<double>& computed, double scale) {
  Errors errors;
  errors.scale = scale;
  double squares = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double error = computed[i] - measured[i];
    squares += error * error;
    errors.max = std::max(errors.max, std::abs(error));
  }
  errors.rms = std::sqrt(squares / static_cast<double>(measured.size()));
  errors.nrmse = errors.rms / scale;
  return errors;
}

std::vector<double> Law::forces_at(const std::vector<double>& depths, std::size_t& beyond) const {
  beyond = 0;
  return with_law(*this, [&](const auto& springs) {
    std::vector<double> forces;
    for (const double depth : depths) {
      const model::ContactResponse response = springs.force_at(depth);
      forces.push_back(response.force);
      beyond += response.saturated ? 1 : 0;
    }
    return forces;
  });
}

double Law::depth_under(double force) const {
  return with_law(*this, [&](const auto& springs) {
    const auto state = springs.deformation_under(force);
    if (state.saturated) {
      throw InputError(fmt::format(
          "a force of {} N: must be at most {} N, the largest that the layers of tissue {} can take",
          shortest(force), shortest(springs.max_force()), tissue.name));
    }
    return state.depth;
  });
}

ForceComparison compare_force(const identify::Specimen& specimen, const Law& law, const Zeros& zeros) {
  ForceComparison comparison;
  comparison.measured = identify::thinned(specimen, kMaxPoints);
  comparison.rows = specimen.size();
  comparison.zeros = zeros;
  const identify::Specimen& measured = comparison.measured;
  std::vector<double> depths;
  for (const double displacement : measured.displacement)
    depths.push_back(displacement - zeros.first_contact);
  std::vector<double> force = law.forces_at(depths, comparison.beyond);
  if (!law.tissue.relaxation.empty() && measured.time.size() > 1) {
    identify::relax(law.tissue.relaxation, measured.time, force);
  }
  std::size_t within = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] = std::max(0.0, force[i]) + zeros.force;
    const double loaded = std::abs(measured.force[i] - zeros.force);
    within += std::abs(force[i] - measured.force[i]) <= kForceJnd * loaded ? 1 : 0;
  }
  const auto [least, most] = std::minmax_element(measured.force.begin(), measured.force.end());
  comparison.errors = errors_of(measured.force, force, *most - *least);
  comparison.within_jnd = static_cast<double>(within) / static_cast<double>(force.size());
  comparison.computed = std::move(force);
  return comparison;
}

DeformationComparison compare_deformation(const Deformation& deformation, const model::FalloffRatios& reach,
                                          double depth, double tip_radius, const SurfaceRule& rule) {
  DeformationComparison comparison;
  comparison.rule = rule;
  comparison.measured = deformation;
  comparison.depth = depth > 0.0 ? depth : deformation.depth;
  comparison.tip_radius = tip_radius;
  if (!(comparison.depth > 0.0)) {
    throw InputError(deformation.name +
                     ": the depth is missing: give --depth-mm or --force-N, or a column depth_mm");
  }
  const double largest = *std::max_element(deformation.displacement.begin(), deformation.displacement.end());
  if (largest > 2.0 * comparison.depth) {
    throw InputError(fmt::format("{}: u_mm goes to {}, must be at most twice the depth, {} mm",
                                 deformation.name, shortest(largest / kMillimetre),
                                 shortest(comparison.depth / kMillimetre)));
  }
  const BallSurface surface(reach, comparison.depth, tip_radius, rule);
  for (const double r : deformation.distance) comparison.computed.push_back(surface.at(r));
  comparison.errors = errors_of(deformation.displacement, comparison.computed, comparison.depth);
  return comparison;
}

}  // namespace palpate::validate
