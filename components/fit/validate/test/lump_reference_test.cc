// The energy law of inclusions against finite elements (tools/update_lump_references).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
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

/// The cases of a file; the first columns may name the tip, which is otherwise 5 mm.
/// @param shallowest of the depths that count [m]
std::vector<LumpCase> cases_of(const std::string& file, double shallowest) {
  enum Column : std::size_t { kRadius, kDepth, kRatio, kOffset, kPress, kForce, kUniform, kTip };
  const bool one_tip = file == "lumps-nu45.csv";
  std::vector<CsvColumn> columns = {{"a_mm"},     {"h_mm"},    {"ratio"},    {"offset_mm"},
                                    {"depth_mm"}, {"force_N"}, {"uniform_N"}};
  if (!one_tip) columns.push_back({"tip_mm"});
  CsvTable table(std::string(PALPATE_REFERENCES) + "/" + file, columns);
  using Row = std::array<double, 8>;
  std::map<std::array<double, 4>, std::vector<Row>> rows;
  std::map<double, std::map<double, double>> uniform;
  while (table.next_row()) {
    Row row{};
    row[kTip] = 5.0;
    for (std::size_t i = 0; i < columns.size(); ++i) row[i] = table.number(i);
    rows[{row[kRadius], row[kDepth], row[kRatio], row[kTip]}].push_back(row);
    uniform[row[kTip]][row[kPress] * kMillimetre] = row[kUniform];
  }
  std::vector<LumpCase> cases;
  for (const auto& [key, points] : rows) {
    LumpCase one;
    one.radius = key[kRadius] * kMillimetre;
    one.depth = key[kDepth] * kMillimetre;
    one.ratio = key[kRatio];
    const std::map<double, double> energy = energy_of(uniform.at(key[3]));
    const model::InclusionLaw law(one.radius, one.depth, one.ratio);
    for (const Row& row : points) {
      const double press = row[kPress] * kMillimetre;
      if (press < shallowest) continue;
      const double offset = row[kOffset] * kMillimetre;
      const model::InclusionLaw::Extra extra =
          law.at(model::PressedTip(row[kTip] * kMillimetre, press), offset * offset);
      const model::CappedFactor factor = model::cap_factor(1.0 + extra.energy);
      one.by_depth[press].push_back(
          {offset, row[kForce] - row[kUniform],
           row[kUniform] * (factor.value - 1.0) + energy.at(press) * factor.slope * extra.by_depth});
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

/// Expects errors of at most `worst` at each depth of a press, and a median of at most `median`.
void expect_errors(const std::vector<LumpCase>& cases, std::size_t count, double median, double worst) {
  std::vector<double> errors;
  for (const LumpCase& one : cases) {
    for (const auto& [press, points] : one.by_depth) {
      errors.push_back(error_of_rise(points));
      EXPECT_LE(errors.back(), worst)
          << one.radius << ' ' << one.depth << ' ' << one.ratio << " at " << press;
    }
  }
  ASSERT_EQ(errors.size(), count);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  EXPECT_LE(*middle, median);
}

TEST(LumpReferences, TheRiseOfForceIsWithinTenPercentInTheMedianAndTwentyInTheWorst) {
  const std::vector<LumpCase> cases = cases_of("lumps-nu45.csv", 0.99e-3);
  ASSERT_EQ(cases.size(), 60U);
  expect_errors(cases, 300U, 0.10, 0.20);
}

// Balls of 3.16 and 5 mm, 0.5 to 3 mm deep, above 0.2 to 1 mm of tissue.
TEST(LumpReferences, SoItIsJustUnderTheSkin) {
  const std::vector<LumpCase> cases = cases_of("lumps-nu45-near.csv", 0.49e-3);
  ASSERT_EQ(cases.size(), 30U);
  expect_errors(cases, 120U, 0.10, 0.20);
}

TEST(LumpReferences, TheWidthAtHalfHeightIsWithinFifteenPercent) {
  for (const LumpCase& one : cases_of("lumps-nu45.csv", 0.99e-3)) {
    for (const auto& [press, points] : one.by_depth) {
      const double reference = half_width(points, &LumpPoint::rise);
      EXPECT_NEAR(half_width(points, &LumpPoint::law), reference, 0.15 * reference)
          << one.radius << ' ' << one.depth << ' ' << one.ratio << " at " << press;
    }
  }
}

}  // namespace
}  // namespace palpate::validate
