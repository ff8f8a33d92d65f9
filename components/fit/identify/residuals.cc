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

/// @param slope by the depth [N/m], one per point; empty: not wanted
template <typename Law>
void elastic(const Law& law, const Specimen& specimen, double first_contact, std::span<double> force,
             std::span<double> slope) {
  for (std::size_t i = 0; i < force.size(); ++i) {
    const bool held = i > 0 && specimen.displacement[i] == specimen.displacement[i - 1];
    if (held) {
      force[i] = force[i - 1];
      if (!slope.empty()) slope[i] = slope[i - 1];
      continue;
    }
    const double depth = specimen.displacement[i] - first_contact;
    if (slope.empty()) {
      force[i] = law.elastic_force(depth);
      continue;
    }
    const model::ContactResponse response = law.force_at(depth);
    force[i] = response.force;
    slope[i] = depth > 0.0 ? response.stiffness : 0.0;
  }
}

/// Elastic forces [N] at the points of a specimen. @throws ParameterError where the parameters are no law
void elastic_forces(const Specimen& specimen, const Settings& settings, const model::TissueParameters& tissue,
                    double first_contact, std::span<double> force, std::span<double> slope = {}) {
  if (settings.law == model::LawKind::kSmooth) {
    elastic(model::SmoothSpringLaw(tissue, settings.direction, settings.period), specimen, first_contact,
            force, slope);
  } else {
    elastic(model::LayeredSpringLaw(tissue, settings.direction, settings.period), specimen, first_contact,
            force, slope);
  }
}

/// Calls visit(relaxation, i) for each point but the first, with the relaxation over the time before it.
template <typename Visit>
void for_each_step(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
                   const Visit& visit) {
  constexpr double kSameStep = 1e-6;  // relative tolerance: times in a file have few digits
  double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  model::Relaxation relaxation(terms, step);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double wanted = time[i] - time[i - 1];
    if (std::abs(wanted - step) > kSameStep * step) {
      step = wanted;
      relaxation.set_step(step);
    }
    visit(relaxation, i);
  }
}

/// The state at the first point, whose force is treated as applied at that instant.
model::RelaxationState state_at(double force) {
  model::RelaxationState state;
  state.elastic = force;
  state.history.fill(force);
  return state;
}

/// The relaxation terms in the order of the parameters.
std::vector<model::RelaxationTerm> terms_of(std::span<const double> shared) {
  std::vector<model::RelaxationTerm> terms;
  double whole = 1.0;
  for (std::size_t i = kLawParameters; i < shared.size(); i += 2) whole += portable::exp(shared[i]);
  for (std::size_t i = kLawParameters; i < shared.size(); i += 2) {
    terms.push_back({portable::exp(shared[i]) / whole, portable::exp(shared[i + 1])});
  }
  return terms;
}

/// Derivatives of the forces at a specimen's points, limited to >= 0, by each parameter but the offset: one
/// column each.
using Columns = std::vector<std::vector<double>>;

/// Half the step of central differences: of a logarithm.
constexpr double kStep = 1e-6;

/// Unrelaxed force q of a term of this time constant.
std::vector<double> unrelaxed(double tau, const std::vector<double>& time, std::span<const double> force) {
  const model::RelaxationTerm term{0.5, tau};  // q does not depend on the share
  model::RelaxationState state = state_at(force[0]);
  std::vector<double> found(force.size(), force[0]);
  for_each_step({&term, 1}, time, [&](const model::Relaxation& relaxation, std::size_t i) {
    (void)relaxation.next(state, force[i]);
    found[i] = state.history[0];
  });
  return found;
}

/// Relaxes the columns of elastic forces and slopes, and sets those of the relaxation's parameters.
/// Relaxation is linear in the elastic force; F = F_e - sum g_i (F_e - q_i).
void relax_columns(std::span<const double> shared, const std::vector<double>& time, Columns& columns) {
  const std::vector<model::RelaxationTerm> terms = terms_of(shared);
  const std::vector<double> elastic = columns[0];
  std::vector<std::size_t> relaxed;  // columns
  std::vector<model::RelaxationState> states;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c >= kLawParameters && c < shared.size()) continue;
    relaxed.push_back(c);
    states.push_back(state_at(columns[c][0]));
  }
  Columns lost(terms.size(), std::vector<double>(time.size(), 0.0));  // F_e - q_i
  for_each_step(terms, time, [&](const model::Relaxation& relaxation, std::size_t i) {
    for (std::size_t n = 0; n < relaxed.size(); ++n) {
      double& force = columns[relaxed[n]][i];
      force = relaxation.next(states[n], force);
    }
    for (std::size_t t = 0; t < terms.size(); ++t) lost[t][i] = elastic[i] - states[0].history.at(t);
  });
  for (std::size_t t = 0; t < terms.size(); ++t) {
    std::vector<double>& by_share = columns[kLawParameters + 2 * t];
    std::vector<double>& by_time = columns[kLawParameters + 2 * t + 1];
    const double factor = portable::exp(kStep);
    const std::vector<double> above = unrelaxed(terms[t].tau * factor, time, elastic);
    const std::vector<double> below = unrelaxed(terms[t].tau / factor, time, elastic);
    for (std::size_t i = 0; i < time.size(); ++i) {
      double all = 0.0;
      for (std::size_t k = 0; k < terms.size(); ++k) all += terms[k].g * lost[k][i];
      by_share[i] = terms[t].g * (all - lost[t][i]);
      by_time[i] = terms[t].g * (above[i] - below[i]) / (2.0 * kStep);
    }
  }
}

/// @throws ParameterError where the parameters are no law
Columns force_slopes(const Problem& problem, const Part& part, std::span<const double> shared,
                     std::span<const double> own) {
  const Specimen& specimen = *part.specimen;
  const std::size_t points = specimen.size();
  const double first_contact = own[0] * part.ranges.displacement;
  Columns columns(shared.size() + 1, std::vector<double>(points, 0.0));  // the last one: of first contact
  elastic_forces(specimen, problem.settings, tissue_of(shared, problem.settings), first_contact, columns[0],
                 columns.back());
  for (double& slope : columns.back()) slope *= -part.ranges.displacement;
  Point moved(shared.begin(), shared.end());
  std::vector<double> above(points);
  std::vector<double> below(points);
  for (std::size_t c = 1; c < kLawParameters; ++c) {
    for (const bool up : {true, false}) {
      moved[c] = shared[c] + (up ? kStep : -kStep);
      elastic_forces(specimen, problem.settings, tissue_of(moved, problem.settings), first_contact,
                     up ? above : below);
    }
    moved[c] = shared[c];
    for (std::size_t r = 0; r < points; ++r) columns[c][r] = (above[r] - below[r]) / (2.0 * kStep);
  }
  if (shared.size() > kLawParameters && specimen.time.size() > 1) {
    relax_columns(shared, specimen.time, columns);
  }
  for (std::size_t r = 0; r < points; ++r) {
    if (!(columns[0][r] <= 0.0)) continue;
    for (std::vector<double>& column : columns) column[r] = 0.0;
  }
  return columns;
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
  const std::size_t points = part.specimen->size();
  const std::size_t width = shared.size() + own.size();
  const double offset = own[1] * part.ranges.force;
  std::vector<double> out((points + kOwnParameters) * width);
  try {
    const Columns columns = force_slopes(problem, part, shared, own);
    for (std::size_t r = 0; r < points; ++r) {
      const double force = columns[0][r] + offset;  // the law is proportional to k_1
      const double residual = (force - part.specimen->force[r]) / part.ranges.force;
      const double unit = std::sqrt(part.weight[r]) * slope_of_loss(residual, problem.loss_scale) /
                          part.ranges.force;  // change of a residual per 1 N
      double* const row = out.data() + r * width;
      for (std::size_t c = 0; c < columns.size(); ++c) row[c] = unit * columns[c][r];
      row[width - 1] = unit * part.ranges.force;
    }
  } catch (const ParameterError&) {  // infinite force for an extreme parameter set
    std::fill(out.begin(), out.end(), std::numeric_limits<double>::quiet_NaN());
  }
  out[points * width + shared.size()] = problem.sigma / part.prior.first_contact_spread;
  out[(points + 1) * width + shared.size() + 1] = problem.sigma / part.prior.offset_spread;
  return out;
}

void relax(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
           std::span<double> force) {
  model::RelaxationState state = state_at(force[0]);
  for_each_step(terms, time, [&](const model::Relaxation& relaxation, std::size_t i) {
    force[i] = relaxation.next(state, force[i]);
  });
}

void predict(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
             std::span<const double> shared, std::span<const double> own, std::span<double> force) {
  try {
    const model::TissueParameters tissue = tissue_of(shared, settings);
    const double first_contact = own[0] * ranges.displacement;
    const double offset = own[1] * ranges.force;
    elastic_forces(specimen, settings, tissue, first_contact, force);
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
