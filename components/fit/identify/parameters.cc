#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/loading.h"

namespace palpate::identify {
namespace {

using portable::exp;
using portable::log;

}  // namespace

Ranges ranges_of(const Specimen& specimen) {
  Ranges ranges;
  const auto [near, far] = std::minmax_element(specimen.displacement.begin(), specimen.displacement.end());
  const auto [weak, strong] = std::minmax_element(specimen.force.begin(), specimen.force.end());
  if (near == specimen.displacement.end() || !(*far > *near) || !(*strong > *weak)) {
    throw InputError("specimen " + specimen.name + ": displacement and force must change");
  }
  ranges.lowest_displacement = *near;
  ranges.displacement = *far - *near;
  ranges.lowest_force = *weak;
  ranges.force = *strong - *weak;
  if (specimen.time.size() < 2) return ranges;
  ranges.duration = specimen.time.back() - specimen.time.front();
  ranges.shortest_step = ranges.duration;
  for (std::size_t i = 1; i < specimen.time.size(); ++i) {
    ranges.shortest_step = std::min(ranges.shortest_step, specimen.time[i] - specimen.time[i - 1]);
  }
  return ranges;
}

double flat_until(const Specimen& specimen, const Ranges& ranges) {
  constexpr std::size_t kFewest = 5;       // points
  constexpr double kShortest = 0.05;       // of the range of displacement
  constexpr double kErrors = 2.5;          // standard errors above which a slope counts as a rise
  constexpr double kSmallestNoise = 1e-6;  // of the range of force
  const std::size_t rows = specimen.size();
  std::vector<std::size_t> order(rows);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&specimen](std::size_t a, std::size_t b) {
    return specimen.displacement[a] < specimen.displacement[b];
  });
  std::vector<double> force;
  for (const std::size_t i : order) force.push_back(specimen.force[i]);
  // Use the order of the rows: sorted by displacement, loading and unloading alternate and hysteresis would
  // count as noise.
  const double noise =
      std::max(std::min(noise_of_rows(force), noise_of_rows(specimen.force)), kSmallestNoise * ranges.force);
  double until = ranges.lowest_displacement;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;  // sums over displacement (from the lowest) and force
  for (std::size_t i = 0; i < rows; ++i) {
    const double way = specimen.displacement[order[i]] - ranges.lowest_displacement;
    x += way;
    y += force[i];
    xx += way * way;
    xy += way * force[i];
    const auto n = static_cast<double>(i + 1);
    const double spread = xx - x * x / n;
    if (i + 1 < kFewest || way < kShortest * ranges.displacement || !(spread > 0.0)) continue;
    const double slope = (xy - x * y / n) / spread;
    if (slope > kErrors * noise / std::sqrt(spread)) continue;
    until = specimen.displacement[order[i]];
  }
  return until;
}

OwnPrior own_prior(const Ranges& ranges) {
  constexpr double kFarStart = 0.25;  // of the range: a larger first displacement is not counted from contact
  constexpr double kLate = 0.05;      // of the range: larger than a usual zero error of a sensor
  const double start = ranges.lowest_displacement / ranges.displacement;
  OwnPrior prior;
  prior.first_contact = std::abs(start) > kFarStart ? start : 0.0;
  const double late = ranges.lowest_force / ranges.force;
  if (late > kLate) {
    prior.first_contact_spread += late;
    prior.offset_spread += late;
  }
  return prior;
}

Bounds own_bounds(const OwnPrior& prior) {
  constexpr double kSpreads = 5.0;
  const double contact = kSpreads * prior.first_contact_spread;
  const double offset = kSpreads * prior.offset_spread;
  return {{prior.first_contact - contact, prior.offset - offset},
          {prior.first_contact + contact, prior.offset + offset}};
}

Bounds shared_bounds(const Ranges& ranges, std::size_t terms) {
  const double stiffness = ranges.force / ranges.displacement;
  Bounds bounds;
  bounds.low = {log(1e-5 * stiffness), log(0.2), log(0.05), log(0.02 * ranges.displacement)};
  bounds.high = {log(1e2 * stiffness), log(20.0), log(3.0), log(10.0 * ranges.displacement)};
  for (std::size_t i = 0; i < terms; ++i) {
    bounds.low.insert(bounds.low.end(), {log(1e-3), log(0.5 * ranges.shortest_step)});
    bounds.high.insert(bounds.high.end(), {log(1e3), log(10.0 * ranges.duration)});
  }
  return bounds;
}

std::vector<double> values_of(std::span<const double> shared, std::span<const double> own,
                              const Ranges& ranges) {
  std::vector<double> values;
  for (std::size_t i = 0; i < kLawParameters; ++i) values.push_back(exp(shared[i]));
  std::vector<model::RelaxationTerm> terms;
  double whole = 1.0;
  for (std::size_t i = kLawParameters; i < shared.size(); i += 2) whole += exp(shared[i]);
  for (std::size_t i = kLawParameters; i < shared.size(); i += 2) {
    terms.push_back({exp(shared[i]) / whole, exp(shared[i + 1])});
  }
  std::sort(terms.begin(), terms.end(),
            [](const model::RelaxationTerm& a, const model::RelaxationTerm& b) { return a.tau < b.tau; });
  for (const model::RelaxationTerm& term : terms) values.insert(values.end(), {term.g, term.tau});
  values.insert(values.end(), {own[0] * ranges.displacement, own[1] * ranges.force});
  return values;
}

model::TissueParameters tissue_of(std::span<const double> shared, const Settings& settings) {
  constexpr double kOwn[kOwnParameters] = {0.0, 0.0};
  const std::vector<double> values = values_of(shared, kOwn, {});
  model::TissueParameters tissue;
  tissue.law = settings.law;
  tissue.k1 = values[0];
  tissue.beta = values[1];
  tissue.q = values[2];
  tissue.rest_length = 2.0 * values[3];
  tissue.max_length = 3.0 * values[3];
  tissue.min_length = values[3];
  tissue.t1 = settings.t1;
  for (std::size_t i = kLawParameters; i + kOwnParameters < values.size(); i += 2) {
    tissue.relaxation.push_back({values[i], values[i + 1]});
  }
  return tissue;
}

std::vector<ParameterLabel> labels(std::size_t terms) {
  std::vector<ParameterLabel> all = {
      {"k1_N_per_m", 1.0, true}, {"beta", 1.0, true}, {"q", 1.0, true}, {"limit_mm", kMillimetre, true}};
  for (std::size_t i = 1; i <= terms; ++i) {
    const std::string term = "relaxation " + std::to_string(i);
    all.push_back({term + " share", 1.0, true});
    all.push_back({term + " time_s", 1.0, true});
  }
  all.push_back({"offset_mm", kMillimetre, false});
  all.push_back({"offset_N", 1.0, false});
  return all;
}

}  // namespace palpate::identify
