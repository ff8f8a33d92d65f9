#include "fit/identify/forward.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/relaxation.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::identify {
namespace {

template <typename Law>
void elastic(const Law& law, const Specimen& specimen, double first_contact, std::span<double> force) {
  for (std::size_t i = 0; i < force.size(); ++i) {
    const bool held = i > 0 && specimen.displacement[i] == specimen.displacement[i - 1];
    force[i] = held ? force[i - 1] : law.force_at(specimen.displacement[i] - first_contact).force;
  }
}

}  // namespace

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
