#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/infinity.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/identify.h"
#include "palpate/units.h"

#include "fit/identify/least_squares.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {
namespace {

/// Means of the values between the ends of blocks.
std::vector<double> means(const std::vector<double>& values, const std::vector<std::size_t>& ends) {
  std::vector<double> out;
  if (values.empty()) return out;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += values[i] - values[begin];
    out.push_back(values[begin] + sum / static_cast<double>(end - begin));
    begin = end;
  }
  return out;
}

/// Ends of blocks of `block` neighbours. With times, a block also ends where the displacement has moved by a
/// hundredth of its range: a mean over a step would be a place where the tool never was.
std::vector<std::size_t> block_ends(const Specimen& specimen, std::size_t block) {
  constexpr double kMostMotion = 0.01;  // of the range of displacement
  const std::vector<double>& at = specimen.displacement;
  const auto [near, far] = std::minmax_element(at.begin(), at.end());
  const double most = specimen.time.empty() ? kInfinity : kMostMotion * (*far - *near);
  std::vector<std::size_t> ends;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= at.size(); ++i) {
    if (i < at.size() && i - begin < block && !(std::abs(at[i] - at[begin]) > most)) continue;
    ends.push_back(i);
    begin = i;
  }
  return ends;
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
  if (!table.has(kRadius)) return 0.0;
  const double radius = table.number(kRadius);
  if (!(radius > 0.0)) table.fail(kRadius, "must be > 0");
  if (!kTipRadius.possible.contains(radius * kMillimetre)) {
    table.fail(kRadius, "must be within 0.001 and 1000: is it in mm?");
  }
  return radius * kMillimetre;
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
  const std::vector<std::size_t> ends = block_ends(ordered, block);
  Specimen few = ordered;
  few.time = means(ordered.time, ends);
  few.displacement = means(ordered.displacement, ends);
  few.force = means(ordered.force, ends);
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

std::vector<Specimen> read_rows(const std::filesystem::path& file) {
  const std::string stem = to_text(file.stem());
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
  return all;
}

std::vector<Specimen> read_specimens(const std::filesystem::path& file) {
  const std::string name = to_text(file);
  std::vector<Specimen> all = read_rows(file);
  for (Specimen& specimen : all) {
    const std::string where = all.size() == 1 ? name : name + ": specimen " + specimen.name;
    check_specimen(specimen, where);
  }
  return all;
}

}  // namespace palpate::identify
