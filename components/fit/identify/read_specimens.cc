#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "palpate/error.h"
#include "palpate/identify.h"
#include "palpate/units.h"

namespace palpate::identify {
namespace {

enum Column : std::size_t { kTime, kDisplacement, kForce, kSpecimen };

const std::vector<CsvColumn> kColumns = {
    {"time_s", false}, {"displacement_mm"}, {"force_N"}, {"specimen", false, true}};
constexpr double kLargest = 1e9;  // mm, N or s: larger values would overflow the precision of sums of squares
constexpr std::size_t kMostSpecimens = 10'000;  // per file; more indicates a wrong column

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

std::vector<Specimen> read_specimens(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string stem = file.stem().string();
  CsvTable table(file, kColumns, kLargest);
  std::vector<Specimen> all;
  std::map<std::string, std::size_t, std::less<>> indices;
  while (table.next_row()) {
    const std::string_view cell = table.text(kSpecimen);
    auto found = indices.find(cell);
    if (found == indices.end()) {
      if (all.size() == kMostSpecimens) {
        table.fail(fmt::format("specimen = {}: more than {} specimens, is this the right column?",
                               excerpt(cell), kMostSpecimens));
      }
      found = indices.emplace(cell, all.size()).first;
      all.emplace_back().name = excerpt(cell.empty() ? std::string_view(stem) : cell);
    }
    add_row(all[found->second], table);
  }
  for (const Specimen& specimen : all) {
    check_specimen(specimen, all.size() == 1 ? name : name + ": specimen " + specimen.name);
  }
  return all;
}

}  // namespace palpate::identify
