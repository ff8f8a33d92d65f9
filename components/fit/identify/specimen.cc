#include <algorithm>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {
namespace {

/// Means of `block` neighbours each.
std::vector<double> means(const std::vector<double>& values, std::size_t block) {
  std::vector<double> out;
  for (std::size_t begin = 0; begin < values.size(); begin += block) {
    const std::size_t end = std::min(begin + block, values.size());
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += values[i] - values[begin];
    out.push_back(values[begin] + sum / static_cast<double>(end - begin));
  }
  return out;
}

enum Column : std::size_t { kTime, kDisplacement, kForce, kSpecimen, kRadius };

const std::vector<CsvColumn> kColumns = {{"time_s", false, false, true},
                                         {"displacement_mm"},
                                         {"force_N"},
                                         {"specimen", false, true},
                                         {"indenter_radius_mm", false}};
constexpr double kLargest = 1e9;  // mm, N or s: larger values would overflow the precision of sums of squares
constexpr std::size_t kMaxSpecimens = 10'000;  // per file; more indicates a wrong column

void add_row(Specimen& specimen, const CsvTable& table) {
  const double displacement = table.number(kDisplacement) * kMillimetre;
  const double force = table.number(kForce);
  if (displacement == 0.0 && force == 0.0 && specimen.size() > 0 && specimen.displacement.back() != 0.0) {
    ++specimen.empty_rows;
    return;
  }
  if (table.has(kTime)) {
    const double time = table.number(kTime);
    if (!specimen.time.empty() && !(time > specimen.time.back())) {
      table.fail(kTime, "must be later than the row before, " + shortest(specimen.time.back()));
    }
    specimen.time.push_back(time);
  }
  specimen.displacement.push_back(displacement);
  specimen.force.push_back(force);
}

/// The row's radius of the indenter [m]; 0 without that column. @throws InputError
double radius_of(const CsvTable& table) {
  constexpr double kSmallest = 1e-3;  // mm
  constexpr double kLargestTip = 1e3;
  if (!table.has(kRadius)) return 0.0;
  const double radius = table.number(kRadius);
  if (!(radius > 0.0)) table.fail(kRadius, "must be > 0");
  if (radius < kSmallest || radius > kLargestTip) {
    table.fail(kRadius, "must be within 0.001 and 1000: is it in mm?");
  }
  return radius * kMillimetre;
}

/// Whether the force does not rise out of its noise anywhere.
bool is_flat(const Specimen& s) {
  const Ranges ranges = ranges_of(s);
  return flat_until(s, ranges) >= ranges.lowest_displacement + ranges.displacement;
}

/// The specimen with the sign of its force inverted.
Specimen negated(Specimen s) {
  for (double& force : s.force) force = -force;
  return s;
}

/// Rejects data that no law can be fitted to. @param where file and specimen, for the message
void check_specimen(const Specimen& s, const std::string& where) {
  if (s.size() < kFewestPoints) {
    throw InputError(fmt::format(
        "{}: has {}{}{}, must have at least {}", where, s.size(), s.size() == 1 ? " row" : " rows",
        s.empty_rows > 0 ? fmt::format(" and {} of 0 mm and 0 N", s.empty_rows) : "", kFewestPoints));
  }
  const auto [low, high] = std::minmax_element(s.displacement.begin(), s.displacement.end());
  const auto [weak, strong] = std::minmax_element(s.force.begin(), s.force.end());
  if (!(*high > *low)) {
    throw InputError(fmt::format("{}: displacement_mm is {} in every row, must change", where,
                                 shortest(*low / kMillimetre)));
  }
  if (!(*strong > *weak)) {
    throw InputError(fmt::format("{}: force_N is {} in every row, must change", where, shortest(*weak)));
  }
  if (*high <= 0.0) {
    throw InputError(where +
                     ": displacement_mm is never above 0; pressing in and pulling out both count "
                     "positive, with --direction for which");
  }
  const bool flat = is_flat(s);
  if (flat ? !is_flat(negated(s)) : !(correlation(s.displacement, s.force) > 0.0)) {
    throw InputError(where +
                     ": force_N falls as displacement_mm rises; pressing in and pulling out both "
                     "count positive, with --direction for which");
  }
  if (flat) {
    throw InputError(where +
                     ": force_N does not rise out of its noise anywhere: the tool seems not to have touched");
  }
}

}  // namespace

Specimen by_displacement(const Specimen& specimen) {
  std::vector<std::size_t> order(specimen.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&specimen](std::size_t a, std::size_t b) {
    return specimen.displacement[a] < specimen.displacement[b];
  });
  Specimen sorted = specimen;
  sorted.time.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.displacement[i] = specimen.displacement[order[i]];
    sorted.force[i] = specimen.force[order[i]];
  }
  return sorted;
}

Specimen thinned(const Specimen& specimen, std::size_t most) {
  if (specimen.size() <= most) return specimen;
  const std::size_t block = (specimen.size() + most - 1) / most;
  const Specimen ordered = specimen.time.empty() ? by_displacement(specimen) : specimen;
  Specimen few = ordered;
  few.time = means(ordered.time, block);
  few.displacement = means(ordered.displacement, block);
  few.force = means(ordered.force, block);
  return few;
}

std::vector<Part> pooled_parts(const std::vector<Specimen>& pooled) {
  constexpr double kWeight = 100.0;  // total weight of a specimen
  std::vector<Part> parts;
  for (const Specimen& specimen : pooled) {
    parts.push_back(make_part(specimen));
    const double equal = kWeight / static_cast<double>(specimen.size());
    for (double& weight : parts.back().weight) weight = equal;
  }
  return parts;
}

std::vector<Specimen> read_specimens(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string stem = file.stem().string();
  CsvTable table(file, kColumns, kLargest);
  std::vector<Specimen> all;
  std::map<std::pair<std::string, double>, std::size_t> indices;  // by name and indenter
  while (table.next_row()) {
    const std::string_view cell = table.text(kSpecimen);
    const double radius = radius_of(table);
    auto found = indices.find({std::string(cell), radius});
    if (found == indices.end()) {
      if (all.size() == kMaxSpecimens) {
        table.fail(fmt::format("specimen = {}: more than {} specimens, is this the right column?",
                               excerpt(cell), kMaxSpecimens));
      }
      found = indices.emplace(std::pair(std::string(cell), radius), all.size()).first;
      all.emplace_back().name = excerpt(cell.empty() ? std::string_view(stem) : cell);
      all.back().tip_radius = radius;
    }
    add_row(all[found->second], table);
  }
  for (Specimen& specimen : all) {
    const std::string where = all.size() == 1 ? name : name + ": specimen " + specimen.name;
    check_specimen(specimen, where);
    require_plausible(specimen, where);
  }
  return all;
}

}  // namespace palpate::identify
