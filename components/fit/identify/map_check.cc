#include "fit/identify/map_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/inclusion.h"
#include "palpate/units.h"

#include "fit/identify/loading.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {
namespace {

using Probes = std::map<int, std::vector<MapRow>>;

Probes by_probe(const std::vector<MapRow>& rows) {
  Probes probes;
  for (const MapRow& row : rows) probes[row.probe].push_back(row);
  return probes;
}

Specimen curve_of_rows(const std::vector<MapRow>& rows) {
  Specimen curve;
  for (const MapRow& row : rows) {
    curve.displacement.push_back(row.depth);
    curve.force.push_back(row.force);
  }
  return curve;
}

/// The rows of one probe belong to one place of the surface. @throws InputError
void require_one_place(const Probes& probes) {
  for (const auto& [probe, rows] : probes) {
    for (const MapRow& row : rows) {
      const double apart = (row.point - rows.front().point).norm();
      if (apart <= model::kFarthestStiffnessPoint) continue;
      throw InputError(fmt::format(
          "probe {}: its rows are {} mm apart: x_mm, y_mm and z_mm must be the same place of the surface at "
          "rest in all rows of a probe",
          probe, brief(apart / kMillimetre, 3)));
    }
  }
}

/// Keeps the last loading of each probe. @return the number of rows left out
std::size_t keep_loadings(const Probes& probes, std::vector<MapRow>& rows) {
  std::vector<MapRow> kept;
  for (const auto& [probe, all] : probes) {
    const Specimen curve = curve_of_rows(all);
    const auto [low, high] = std::minmax_element(curve.displacement.begin(), curve.displacement.end());
    const auto [weak, strong] = std::minmax_element(curve.force.begin(), curve.force.end());
    if (all.size() < kFewestPoints || !(*high > *low) || !(*strong > *weak)) {
      kept.insert(kept.end(), all.begin(), all.end());
      continue;
    }
    const Specimen loading = whole_loading(curve);
    for (std::size_t i = 0; i < loading.size(); ++i) {
      MapRow row = all.front();
      row.depth = loading.displacement[i];
      row.force = loading.force[i];
      kept.push_back(row);
    }
  }
  const std::size_t left_out = rows.size() - kept.size();
  if (left_out > 0) rows = std::move(kept);
  return left_out;
}

/// The force that the shallowest rows of the probes read, as a median [N], where they are near depth 0.
double first_reading(const Probes& probes, double deepest) {
  constexpr double kNearZero = 0.02;  // of the deepest depth
  std::vector<double> forces;
  for (const auto& [probe, rows] : probes) {
    const auto first = std::min_element(rows.begin(), rows.end(),
                                        [](const MapRow& a, const MapRow& b) { return a.depth < b.depth; });
    if (first->depth <= kNearZero * deepest) forces.push_back(first->force);
  }
  return forces.size() < kFewestProbes ? 0.0 : median(std::move(forces));
}

/// Extent of the probes [m]: the diagonal of the box around them.
double extent_of(const std::vector<MapRow>& rows) {
  Vec3 low = rows.front().point;
  Vec3 high = low;
  for (const MapRow& row : rows) {
    low = low.cwiseMin(row.point);
    high = high.cwiseMax(row.point);
  }
  return (high - low).norm();
}

void add_doubt_of_zero(const Probes& probes, const Specimen& all, std::vector<std::string>& out) {
  constexpr double kLarge = 0.1;     // of the range of force
  constexpr double kMatters = 0.02;  // likewise
  const Ranges ranges = ranges_of(all);
  const double reading = first_reading(probes, ranges.lowest_displacement + ranges.displacement);
  if (reading < -kLarge * ranges.force) {
    throw InputError(fmt::format(
        "force_N: the probes read {} N at depth 0: no tissue pulls, so tare the sensor and count pressing "
        "positive",
        brief(reading, 3)));
  }
  if (reading < -kMatters * ranges.force) {
    out.push_back(
        fmt::format("the probes read {} N at depth 0, and no tissue pulls: forces come out too low. Tare the "
                    "sensor, or subtract this",
                    brief(reading, 3)));
  }
  if (reading > kMatters * ranges.force) {
    out.push_back(fmt::format(
        "the probes read {} N at depth 0, {} of the range of force: taken as a touch before that row. If the "
        "sensor was not tared, subtract it",
        brief(reading, 3), percent(reading / ranges.force, 0)));
  }
  constexpr double kLateContact = 0.15;  // of the deepest depth
  const double flat = flat_until(all, ranges);
  if (flat > kLateContact * (ranges.lowest_displacement + ranges.displacement)) {
    out.push_back(
        fmt::format("the force does not rise out of the noise before {} mm: count depth_mm from contact",
                    brief(flat / kMillimetre, 3)));
  }
}

}  // namespace

std::vector<std::string> check_map(std::vector<MapRow>& rows, double tip_radius) {
  require_tip_radius("--radius-mm", tip_radius);
  std::vector<std::string> out;
  if (rows.empty()) return out;
  const Probes probes = by_probe(rows);
  require_one_place(probes);
  Specimen all = curve_of_rows(rows);
  const auto [weak, strong] = std::minmax_element(all.force.begin(), all.force.end());
  const auto [near, far] = std::minmax_element(all.displacement.begin(), all.displacement.end());
  if (!(*strong > *weak) || !(*far > *near)) return out;  // refused by the fit
  if (is_flat(all)) {
    throw InputError(
        "force_N does not rise out of its noise with depth_mm: the tool seems not to have touched");
  }
  all.tip_radius = tip_radius;
  out = unit_questions(all);
  add_doubt_of_zero(probes, all, out);
  if (const double extent = extent_of(rows); !kOrganExtent.possible.contains(extent)) {
    out.push_back(fmt::format("all probes lie within {}{}", in_unit(kOrganExtent, extent),
                              column_question(kOrganExtent, extent, "x_mm", kMillimetre)));
  }
  if (const std::size_t left_out = keep_loadings(probes, rows); left_out > 0) {
    out.push_back(
        fmt::format("depth_mm decreases within probes: {} rows are left out, of each probe the last "
                    "whole loading stays",
                    left_out));
  }
  return out;
}

}  // namespace palpate::identify
