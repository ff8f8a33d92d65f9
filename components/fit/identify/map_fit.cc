#include "fit/identify/map_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/units.h"

#include "fit/identify/map_model.h"
#include "fit/identify/map_problem.h"

namespace palpate::identify {
namespace {

constexpr double kEvidence = 10.0;  // least fall of the information criterion for an inclusion

/// Where the residuals ask most for another inclusion: the probe with the largest sum over its neighbourhood,
/// each residual relative to the background. @return the point in the map's frame [mm], and the sign
std::pair<Vec3, double> most_wanted(const MapProblem& map, std::span<const double> values) {
  const Values forces = map.model().forces(values, map.rows());
  std::map<int, std::pair<double, double>> by_probe;  // sums of the residual and of the force
  std::map<int, Vec3> place;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const MapRow& row = map.rows()[i];
    by_probe[row.probe].first += row.force - forces[i];
    by_probe[row.probe].second += forces[i];
    place[row.probe] = map.model().frame().local(row.point) / kMillimetre;
  }
  const double area = std::pow(2.0 * map.model().frame().extent / kMillimetre, 2);
  const double near = 1.5 * area / static_cast<double>(by_probe.size());  // mm^2, about the next probes
  std::pair<Vec3, double> best{Vec3::Zero(), 0.0};
  for (const auto& [probe, at] : place) {
    double sum = 0.0;
    double total = 0.0;
    for (const auto& [other, sums] : by_probe) {
      const double weight = std::exp(-(place[other] - at).squaredNorm() / near);
      if (!(sums.second > 0.0)) continue;  // no row with a force
      sum += weight * sums.first / sums.second;
      total += weight;
    }
    const double wanted = total > 0.0 ? sum / std::sqrt(total) : 0.0;
    if (std::abs(wanted) > std::abs(best.second)) best = {at, wanted};
  }
  return best;
}

/// The values with one inclusion more, from several depths; the best of them.
Values with_one_more(const MapProblem& map, const Values& values) {
  const auto [at, wanted] = most_wanted(map, values);
  constexpr int kTrial = 12;                                   // iterations before the best start is chosen
  constexpr std::array<double, 3> kDepths = {3.0, 6.0, 12.0};  // mm
  std::array<Values, kDepths.size()> found;
  const Vec3 place = at;
  const double ratio = wanted > 0.0 ? 10.0 : 0.3;
  for_ranges(kDepths.size(), 1, [&](std::size_t i, std::size_t) {
    Values start = values;
    for (const double value : {place.x(), place.y(), kDepths.at(i), std::log(0.6), std::log(ratio)})
      start.push_back(value);
    found.at(i) = solve_map(map, start, std::nullopt, kTrial);
  });
  const auto best = std::min_element(found.begin(), found.end(), [&map](const Values& a, const Values& b) {
    return map.sum_of_squares(a) < map.sum_of_squares(b);
  });
  return solve_map(map, *best);
}

/// Whether the last inclusion is clear of the others: two spheres cannot overlap.
bool is_apart(const MapProblem& map, const Values& values) {
  constexpr double kTouching = 0.7;  // of the sum of the radii; the law is fitted to spheres that are apart
  const auto inclusion = [&](std::size_t i) { return std::span(values).subspan(i, kMapInclusion); };
  const auto radius = [&](std::size_t i) { return values[i + 2] * kMillimetre * std::exp(values[i + 3]); };
  const std::size_t last = values.size() - kMapInclusion;
  for (std::size_t i = map.model().first_inclusion(); i < last; i += kMapInclusion) {
    const double distance = (map.model().centre(inclusion(i)) - map.model().centre(inclusion(last))).norm();
    if (distance < kTouching * (radius(i) + radius(last))) return false;
  }
  return true;
}

/// Whether the last inclusion describes no lump: as deep, as small or as far out as the search goes, it
/// stands for a background that varies.
bool is_of_background(const MapProblem& map, const Values& values) {
  const std::size_t last = values.size() - kMapInclusion;
  for (const MapParameter parameter : bounds_reached(map, values, last)) {
    if (parameter == kAlong || parameter == kAcross) return true;
    if (parameter == kDepthBelow && values[last + kDepthBelow] > 0.5 * kDeepestInclusion) return true;
    if (parameter == kLogThickness && std::exp(values[last + kLogThickness]) < 0.5) return true;
  }
  return false;
}

Values start_values(const std::vector<MapRow>& rows, std::size_t terms) {
  double deepest = 0.0;
  double force = 0.0;
  for (const MapRow& row : rows) {
    deepest = std::max(deepest, row.depth);
    force = std::max(force, row.force);
  }
  Values values(kMapTissue + terms - 1, 0.0);
  values[1] = 1.3;
  values[2] = 0.2;
  values[0] = std::log(0.5 * force) - values[1] * std::log(deepest / kMillimetre + values[2]);
  return values;
}

struct Chosen {
  std::size_t terms = 1;
  Values values;
};

/// Adds terms of the background map and inclusions while the criterion falls by more than kEvidence.
Chosen choose(const std::vector<MapRow>& rows, const MapSettings& settings, const Values& weights,
              const MapProgress& progress) {
  std::vector<MapProblem> problems;
  for (const std::size_t terms : {1U, 3U, 6U}) problems.emplace_back(rows, settings, terms, weights);
  std::size_t level = 0;
  Chosen now{1, solve_map(problems[0], start_values(rows, 1))};
  double criterion = problems[0].criterion(now.values);
  for (;;) {
    const std::size_t count = (now.values.size() - problems[level].model().size(0)) / kMapInclusion;
    if (progress) {
      progress(static_cast<double>(count) / static_cast<double>(settings.max_inclusions + 1),
               fmt::format("{} inclusions", count));
    }
    Values more;
    Values wider;
    for_ranges(2, 1, [&](std::size_t i, std::size_t) {
      if (i == 0 && count < settings.max_inclusions) more = with_one_more(problems[level], now.values);
      if (i == 1 && level + 1 < problems.size()) {
        wider = now.values;
        const std::size_t old_size = problems[level].model().size(0);
        wider.insert(wider.begin() + static_cast<std::ptrdiff_t>(old_size),
                     problems[level + 1].model().size(0) - old_size, 0.0);
        wider = solve_map(problems[level + 1], wider);
      }
    });
    std::optional<Chosen> better;
    double least = criterion - kEvidence;
    std::size_t next_level = level;
    if (!more.empty()) {
      if (const double at = problems[level].criterion(more);
          at < least && is_apart(problems[level], more) && !is_of_background(problems[level], more)) {
        least = at;
        better = Chosen{now.terms, std::move(more)};
      }
    }
    if (!wider.empty()) {
      if (const double at = problems[level + 1].criterion(wider); at < least) {
        least = at;
        better = Chosen{level == 0 ? 3U : 6U, std::move(wider)};
        next_level = level + 1;
      }
    }
    if (!better) return now;
    now = std::move(*better);
    criterion = least;
    level = next_level;
  }
}

double rms(const Values& forces, const std::vector<MapRow>& rows) {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    sum += (forces[i] - rows[i].force) * (forces[i] - rows[i].force);
  }
  return std::sqrt(sum / static_cast<double>(rows.size()));
}

/// One factor a probe: its forces over those of the uniform background tissue, by least squares.
std::vector<model::StiffnessPoint> stiffness_points(const MapModel& model, const Values& values,
                                                    const std::vector<MapRow>& rows) {
  Values tissue(values.begin(), values.begin() + kMapTissue);
  tissue.resize(model.first_inclusion(), 0.0);
  std::map<int, std::pair<double, double>> sums;
  std::map<int, Vec3> place;
  for (const MapRow& row : rows) {
    const double uniform = model.background(tissue, row);
    sums[row.probe].first += uniform * row.force;
    sums[row.probe].second += uniform * uniform;
    place[row.probe] = row.point;
  }
  std::vector<model::StiffnessPoint> points;
  for (const auto& [probe, both] : sums) {
    const double factor = both.second > 0.0 ? both.first / both.second : 1.0;
    points.push_back({place[probe], std::clamp(factor, model::kSmallestFactor, model::kLargestFactor)});
  }
  return points;
}

double deepest_of(const std::vector<MapRow>& rows) {
  double deepest = 0.0;
  for (const MapRow& row : rows) deepest = std::max(deepest, row.depth);
  return deepest;
}

}  // namespace

MapFit search_map(const std::vector<MapRow>& rows, const MapSettings& settings, const MapProgress& progress) {
  std::set<int> probes;
  MapFit fit;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const MapRow& row : rows) {
    probes.insert(row.probe);
    low = std::min(low, row.force);
    high = std::max(high, row.force);
  }
  if (probes.size() < kFewestProbes || rows.size() < kFewestMapRows) {
    throw InputError(fmt::format("the map has {} probes and {} rows: must have at least {} and {}",
                                 probes.size(), rows.size(), kFewestProbes, kFewestMapRows));
  }
  if (!(high > 0.0 && deepest_of(rows) > 0.0))
    throw InputError("the map has no row with a depth and a force above 0");
  fit.rows = rows.size();
  fit.probes = probes.size();
  fit.range = high - low;

  const Values equal(rows.size(), 1.0);
  const Values weights = weights_of(rows);
  const Chosen chosen = choose(rows, settings, weights, progress);
  const MapProblem map(rows, settings, chosen.terms, weights);

  const Values values = moved_off_bounds(map, chosen.values);
  fit.values = values;
  fit.map_terms = chosen.terms;
  fit.exponent = values[1];
  fit.first_depth = values[2] * kMillimetre;
  fit.stiffness = std::exp(values[0]) * std::pow(1.0 / kMillimetre, values[1]);
  fit.error = rms(map.model().forces(values, rows), rows);
  const MapProblem alone(rows, settings, 1, equal);
  fit.uniform_error = rms(alone.model().forces(solve_map(alone, start_values(rows, 1)), rows), rows);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(values.size()),
                                                     static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = map.model().first_inclusion(); i < values.size(); i += kMapInclusion) {
    fit.inclusions.push_back(describe_inclusion(map, values, none, i, deepest_of(rows), false));
  }
  fit.stiffness_map = stiffness_points(map.model(), values, rows);
  return fit;
}

void add_intervals(const std::vector<MapRow>& rows, const MapSettings& settings, MapFit& fit,
                   const MapProgress& progress) {
  const Values weights = weights_of(rows);
  const MapProblem map(rows, settings, fit.map_terms, weights);
  const Eigen::MatrixXd covariance = covariance_of(map, fit.values);
  const std::size_t first = map.model().first_inclusion();
  std::mutex mutex;
  double done = 0.0;
  for_ranges(fit.inclusions.size(), 1, [&](std::size_t i, std::size_t) {
    fit.inclusions[i] = describe_inclusion(map, fit.values, covariance, first + i * kMapInclusion,
                                           deepest_of(rows), settings.profiles);
    const std::lock_guard lock(mutex);
    done += 1.0;
    if (progress) progress(done / static_cast<double>(fit.inclusions.size()), "intervals");
  });
}

MapFit fit_map(const std::vector<MapRow>& rows, const MapSettings& settings, const MapProgress& progress) {
  MapFit fit = search_map(rows, settings, progress);
  add_intervals(rows, settings, fit);
  return fit;
}

}  // namespace palpate::identify
