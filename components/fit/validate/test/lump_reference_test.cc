// The energy law of inclusions against finite elements (tools/update_lump_references).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "io/system/csv_table.h"
#include "palpate/inclusion.h"
#include "palpate/units.h"

namespace palpate::validate {
namespace {

struct LumpPoint {
  double offset = 0.0;  // m
  double rise = 0.0;    // N, above the uniform layer
  double law = 0.0;     // N, the same by the law
};

struct LumpCase {
  double radius = 0.0, depth = 0.0, ratio = 0.0;      // m, m, 1
  std::map<double, std::vector<LumpPoint>> by_depth;  // of the press [m]
};

/// Energy [J] of the uniform layer at the depths [m] of `force` [N]: F / D^1.5 is linear between them.
std::map<double, double> energy_of(const std::map<double, double>& force) {
  std::map<double, double> energy;
  double total = 0.0;
  double d0 = 0.0;
  double q0 = force.begin()->second / std::pow(force.begin()->first, 1.5);
  for (const auto& [d1, newton] : force) {
    const double q1 = newton / std::pow(d1, 1.5);
    const double slope = (q1 - q0) / (d1 - d0);
    total += (q0 - slope * d0) * (std::pow(d1, 2.5) - std::pow(d0, 2.5)) / 2.5 +
             slope * (std::pow(d1, 3.5) - std::pow(d0, 3.5)) / 3.5;
    energy[d1] = total;
    d0 = d1;
    q0 = q1;
  }
  return energy;
}

std::vector<LumpCase> cases_of_5_mm_tip() {
  enum Column : std::size_t { kRadius, kDepth, kRatio, kOffset, kPress, kForce, kUniform };
  CsvTable table(std::string(PALPATE_REFERENCES) + "/lumps-nu45.csv",
                 {{"a_mm"}, {"h_mm"}, {"ratio"}, {"offset_mm"}, {"depth_mm"}, {"force_N"}, {"uniform_N"}});
  using Row = std::array<double, 7>;
  std::map<std::tuple<double, double, double>, std::vector<Row>> rows;
  std::map<double, double> uniform;
  while (table.next_row()) {
    Row row{};
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = table.number(i);
    rows[{row[kRadius], row[kDepth], row[kRatio]}].push_back(row);
    uniform[row[kPress] * kMillimetre] = row[kUniform];
  }
  const std::map<double, double> energy = energy_of(uniform);
  std::vector<LumpCase> cases;
  for (const auto& [key, points] : rows) {
    LumpCase one;
    one.radius = std::get<0>(key) * kMillimetre;
    one.depth = std::get<1>(key) * kMillimetre;
    one.ratio = std::get<2>(key);
    const model::InclusionLaw law(one.radius, one.depth, one.ratio);
    for (const Row& row : points) {
      const double press = row[kPress] * kMillimetre;
      if (press < 0.99e-3) continue;
      const double offset = row[kOffset] * kMillimetre;
      const model::InclusionLaw::Extra extra = law.at(model::PressedTip(5e-3, press), offset * offset);
      one.by_depth[press].push_back({offset, row[kForce] - row[kUniform],
                                     row[kUniform] * extra.energy + energy.at(press) * extra.by_depth});
    }
    cases.push_back(one);
  }
  return cases;
}

double peak_of(const std::vector<LumpPoint>& points) {
  double peak = 0.0;
  for (const LumpPoint& one : points) peak = std::max(peak, std::abs(one.rise));
  return peak;
}

/// RMS error over the offsets, divided by the peak.
double error_of_rise(const std::vector<LumpPoint>& points) {
  double sum = 0.0;
  for (const LumpPoint& one : points) sum += (one.law - one.rise) * (one.law - one.rise);
  return std::sqrt(sum / static_cast<double>(points.size())) / peak_of(points);
}

/// Offset [m] at which a curve has fallen to half its value at 0, by linear interpolation.
double half_width(const std::vector<LumpPoint>& points, double LumpPoint::*value) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double before = points[i - 1].*value / (points[0].*value) - 0.5;
    const double after = points[i].*value / (points[0].*value) - 0.5;
    if (after > 0.0) continue;
    return points[i - 1].offset + (points[i].offset - points[i - 1].offset) * before / (before - after);
  }
  return points.back().offset;
}

TEST(LumpReferences, TheRiseOfForceIsWithinTenPercentInTheMedianAndTwentyInTheWorst) {
  const std::vector<LumpCase> cases = cases_of_5_mm_tip();
  ASSERT_EQ(cases.size(), 60U);
  std::vector<double> errors;
  for (const LumpCase& one : cases) {
    for (const auto& [press, points] : one.by_depth) {
      errors.push_back(error_of_rise(points));
      EXPECT_LE(errors.back(), 0.20) << one.radius << ' ' << one.depth << ' ' << one.ratio << " at " << press;
    }
  }
  ASSERT_EQ(errors.size(), 300U);
  std::nth_element(errors.begin(), errors.begin() + 150, errors.end());
  EXPECT_LE(errors[150], 0.10);
}

TEST(LumpReferences, TheWidthAtHalfHeightIsWithinFifteenPercent) {
  for (const LumpCase& one : cases_of_5_mm_tip()) {
    for (const auto& [press, points] : one.by_depth) {
      const double reference = half_width(points, &LumpPoint::rise);
      EXPECT_NEAR(half_width(points, &LumpPoint::law), reference, 0.15 * reference)
          << one.radius << ' ' << one.depth << ' ' << one.ratio << " at " << press;
    }
  }
}

}  // namespace
}  // namespace palpate::validate
