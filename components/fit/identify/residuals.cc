#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/portable_math.h"
#include "core/model/relaxation.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

#include "fit/identify/least_squares.h"

namespace palpate::identify {
namespace {

/// Signed square root of the Cauchy loss of r.
double after_loss(double r, double scale) {
  if (std::isinf(scale)) return r;
  const double share = r / scale;
  return std::copysign(scale * std::sqrt(portable::log1p(share * share)), r);
}

/// Derivative of after_loss() by r.
double slope_of_loss(double r, double scale) {
  const double share = std::abs(r / scale);  // 0 for an infinite scale
  const double square = share * share;
  const double loss = portable::log1p(square);
  return loss > 0.0 ? share / (std::sqrt(loss) * (1.0 + square)) : 1.0;
}

template <typename Law>
void elastic(const Law& law, const Specimen& specimen, double first_contact, std::span<double> force) {
  for (std::size_t i = 0; i < force.size(); ++i) {
    const bool held = i > 0 && specimen.displacement[i] == specimen.displacement[i - 1];
    force[i] = held ? force[i - 1] : law.force_at(specimen.displacement[i] - first_contact).force;
  }
}

}  // namespace

Part make_part(const Specimen& specimen) {
  Part part;
  part.specimen = &specimen;
  part.ranges = ranges_of(specimen);
  part.prior = own_prior(part.ranges);
  const std::optional<double>& contact = specimen.preparation.contact;
  if (contact) part.prior.first_contact = *contact / part.ranges.displacement;
  part.weight.assign(specimen.size(), 1.0);
  return part;
}

Problem make_problem(const Settings& settings, std::size_t terms, std::vector<Part> parts) {
  Problem problem;
  problem.settings = settings;
  problem.terms = terms;
  problem.parts = std::move(parts);
  for (const Part& part : problem.parts) {
    const Bounds bounds = shared_bounds(part.ranges, terms);
    if (problem.bounds.low.empty()) problem.bounds = bounds;
    for (std::size_t i = 0; i < bounds.low.size(); ++i) {
      problem.bounds.low[i] = std::min(problem.bounds.low[i], bounds.low[i]);
      problem.bounds.high[i] = std::max(problem.bounds.high[i], bounds.high[i]);
    }
  }
  return problem;
}

std::size_t residual_count(const Part& part) noexcept { return part.specimen->size() + kOwnParameters; }

void residuals(const Problem& problem, const Part& part, std::span<const double> shared,
               std::span<const double> own, std::span<double> out) {
  const std::size_t points = part.specimen->size();
  predict(*part.specimen, part.ranges, problem.settings, shared, own, out.first(points));
  for (std::size_t i = 0; i < points; ++i) {
    const double residual = (out[i] - part.specimen->force[i]) / part.ranges.force;
    out[i] = std::sqrt(part.weight[i]) * after_loss(residual, problem.loss_scale);
  }
  const OwnPrior& prior = part.prior;
  out[points] = problem.sigma * (own[0] - prior.first_contact) / prior.first_contact_spread;
  out[points + 1] = problem.sigma * (own[1] - prior.offset) / prior.offset_spread;
}

double cost_of(const Problem& problem, const Point& shared, const std::vector<Point>& own) {
  double cost = 0.0;
  std::vector<double> values;
  for (std::size_t p = 0; p < problem.parts.size(); ++p) {
    values.resize(residual_count(problem.parts[p]));
    residuals(problem, problem.parts[p], shared, own[p], values);
    for (const double value : values) cost += value * value;
  }
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

std::vector<double> jacobian(const Problem& problem, const Part& part, std::span<const double> shared,
                             std::span<const double> own) {
  constexpr double kStep = 1e-6;  // in logarithms, or fractions of a range
  const std::size_t points = part.specimen->size();
  const std::size_t columns = shared.size() + own.size();
  Point moved_shared(shared.begin(), shared.end());
  Point moved_own(own.begin(), own.end());
  std::vector<double> above(points);
  std::vector<double> below(points);
  std::vector<double> force(points);
  std::vector<double> unit(points);  // change of a residual per 1 N
  predict(*part.specimen, part.ranges, problem.settings, shared, own, force);
  for (std::size_t r = 0; r < points; ++r) {
    const double residual = (force[r] - part.specimen->force[r]) / part.ranges.force;
    unit[r] = std::sqrt(part.weight[r]) * slope_of_loss(residual, problem.loss_scale) / part.ranges.force;
  }
  std::vector<double> out((points + kOwnParameters) * columns);
  const auto write = [&](std::size_t column, const auto& slope_at) {
    for (std::size_t r = 0; r < points; ++r) out[r * columns + column] = unit[r] * slope_at(r);
  };
  write(0, [&](std::size_t r) {
    return force[r] - own[1] * part.ranges.force;
  });  // the law is proportional to k_1
  write(columns - 1, [&](std::size_t) { return part.ranges.force; });
  for (std::size_t c = 1; c + 1 < columns; ++c) {
    double& moved = c < shared.size() ? moved_shared[c] : moved_own[c - shared.size()];
    const double there = moved;
    moved = there + kStep;
    predict(*part.specimen, part.ranges, problem.settings, moved_shared, moved_own, above);
    moved = there - kStep;
    predict(*part.specimen, part.ranges, problem.settings, moved_shared, moved_own, below);
    moved = there;
    write(c, [&](std::size_t r) { return (above[r] - below[r]) / (2.0 * kStep); });
  }
  out[points * columns + shared.size()] = problem.sigma / part.prior.first_contact_spread;
  out[(points + 1) * columns + shared.size() + 1] = problem.sigma / part.prior.offset_spread;
  return out;
}

void relax(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
           std::span<double> force) {
  constexpr double kSameStep = 1e-6;  // relative tolerance: times in a file have few digits
  double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  model::Relaxation relaxation(terms, step);
  model::RelaxationState state;
  state.elastic = force[0];
  state.history.fill(force[0]);
  for (std::size_t i = 1; i < force.size(); ++i) {
    const double wanted = time[i] - time[i - 1];
    if (std::abs(wanted - step) > kSameStep * step) {
      step = wanted;
      relaxation.set_step(step);
    }
    force[i] = relaxation.next(state, force[i]);
  }
}

void predict(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
             std::span<const double> shared, std::span<const double> own, std::span<double> force) {
  try {
    const model::TissueParameters tissue = tissue_of(shared, settings);
    const double first_contact = own[0] * ranges.displacement;
    const double offset = own[1] * ranges.force;
    if (settings.law == model::LawKind::kSmooth) {
      const model::SmoothSpringLaw law(tissue, settings.direction, settings.period);
      elastic(law, specimen, first_contact, force);
    } else {
      const model::LayeredSpringLaw law(tissue, settings.direction, settings.period);
      elastic(law, specimen, first_contact, force);
    }
    if (!tissue.relaxation.empty() && specimen.time.size() > 1) {
      relax(tissue.relaxation, specimen.time, force);
    }
    for (double& value : force) value = std::max(0.0, value) + offset;
  } catch (const ParameterError&) {  // infinite force for an extreme parameter set
    std::fill(force.begin(), force.end(), std::numeric_limits<double>::quiet_NaN());
  }
}

LayerCount layers_of(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
                     std::span<const double> shared, std::span<const double> own) {
  const model::LayeredSpringLaw law(tissue_of(shared, settings), settings.direction, settings.period);
  const double deepest = *std::max_element(specimen.displacement.begin(), specimen.displacement.end());
  return {law.layers_allowed(), law.force_at(deepest - own[0] * ranges.displacement).cutoff_layer};
}

}  // namespace palpate::identify
