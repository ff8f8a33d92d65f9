#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "io/system/plausible.h"
#include "palpate/error.h"
#include "palpate/units.h"
#include "palpate/validate.h"

namespace palpate::validate {
namespace {

enum DeformationColumn : std::size_t { kDistance, kShift, kDepth };

const std::vector<CsvColumn> kDeformationColumns = {{"r_mm"}, {"u_mm"}, {"depth_mm", false}};
constexpr double kLargestDeformation = 1e6;  // mm
constexpr std::size_t kMaxDepths = 1000;     // per file; more indicates a wrong column

void sort_by_distance(Deformation& deformation) {
  std::vector<std::size_t> order(deformation.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&deformation](std::size_t a, std::size_t b) {
    return std::abs(deformation.distance[a]) < std::abs(deformation.distance[b]);
  });
  Deformation sorted = deformation;
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.distance[i] = std::abs(deformation.distance[order[i]]);
    sorted.displacement[i] = deformation.displacement[order[i]];
  }
  deformation = std::move(sorted);
}

}  // namespace

void check_deformation(Deformation& deformation, const std::string& where) {
  if (deformation.size() < kFewestPlaces) {
    throw InputError(fmt::format("{}: has {}{}, must have at least {}", where, deformation.size(),
                                 deformation.size() == 1 ? " row" : " rows", kFewestPlaces));
  }
  sort_by_distance(deformation);
  if (!(deformation.distance.back() > deformation.distance.front())) {
    throw InputError(fmt::format("{}: r_mm is {} in every row, must change", where,
                                 shortest(deformation.distance.front() / kMillimetre)));
  }
  const double farthest = deformation.distance.back();
  if (!kProfileReach.possible.contains(farthest)) {
    throw InputError(fmt::format(
        "{}: r_mm goes to {}, must be within {} and {}{}", where, in_unit(kProfileReach, farthest),
        brief(kProfileReach.possible.low / kMillimetre), in_unit(kProfileReach, kProfileReach.possible.high),
        column_question(kProfileReach, farthest, "r_mm", kMillimetre)));
  }
  const auto [least, most] =
      std::minmax_element(deformation.displacement.begin(), deformation.displacement.end());
  if (!(*most > *least)) {
    throw InputError(where + ": u_mm is " + shortest(*least / kMillimetre) + " in every row, must change");
  }
  if (!(correlation(deformation.distance, deformation.displacement) < 0.0) || !(*most > 0.0)) {
    throw InputError(where +
                     ": u_mm does not decrease away from the contact; displacement in the direction of the "
                     "tool is positive");
  }
}

Deformation thinned(const Deformation& deformation, std::size_t most) {
  if (deformation.size() <= most) return deformation;
  Deformation few;
  few.name = deformation.name;
  few.depth = deformation.depth;
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t begin = i * deformation.size() / most;
    const std::size_t end = (i + 1) * deformation.size() / most;
    double r = 0.0;
    double u = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      r += deformation.distance[k];
      u += deformation.displacement[k];
    }
    const auto count = static_cast<double>(end - begin);
    few.distance.push_back(r / count);
    few.displacement.push_back(u / count);
  }
  return few;
}

std::vector<Deformation> read_deformations(const std::filesystem::path& file) {
  const std::string name = to_text(file);
  CsvTable table(file, kDeformationColumns, kLargestDeformation);
  std::vector<Deformation> all;
  std::map<double, std::size_t> indices;  // by depth in mm
  while (table.next_row()) {
    const double depth_mm = table.number(kDepth);
    if (table.has(kDepth) && !(depth_mm > 0.0)) table.fail(kDepth, "must be > 0");
    const auto [entry, is_new] = indices.try_emplace(depth_mm, all.size());
    if (is_new) {
      if (all.size() == kMaxDepths) {
        table.fail(kDepth, fmt::format("more than {} depths, is this the right column?", kMaxDepths));
      }
      Deformation& made = all.emplace_back();
      made.name = to_text(file.stem()) + (table.has(kDepth) ? " at " + shortest(depth_mm) + " mm" : "");
      made.depth = depth_mm * kMillimetre;
    }
    Deformation& deformation = all[entry->second];
    deformation.distance.push_back(table.number(kDistance) * kMillimetre);
    deformation.displacement.push_back(table.number(kShift) * kMillimetre);
  }
  for (Deformation& deformation : all) {
    const bool several = all.size() > 1;
    check_deformation(deformation,
                      several ? name + ": depth_mm " + shortest(deformation.depth / kMillimetre) : name);
  }
  return all;
}

}  // namespace palpate::validate
