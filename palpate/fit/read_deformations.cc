#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <string_view>
#include <system_error>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/base/units.h"
#include "palpate/fit/csv_text.h"
#include "palpate/fit/deformation.h"

namespace palpate::fit {
namespace {

enum Column : std::size_t { kDistance, kDisplacement, kDepth, kColumns };

const std::array<std::string, kColumns> kNames = {"r_mm", "u_mm", "depth_mm"};
constexpr std::size_t kMostDepths = 1000;  // of one file; more is a mistaken column

/// Reads one file line by line; every error is FILE:LINE: column = value: what would be right.
class DeformationReader final {
 public:
  DeformationReader(std::string name, std::string stem) : name_(std::move(name)), stem_(std::move(stem)) {}

  void read_line(std::string_view line) {
    ++line_;
    if (line_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    const std::string_view text = trimmed(line);
    if (text.empty() || text.starts_with('#')) return;
    if (columns_.empty()) {
      read_header(text);
    } else {
      read_row(text);
    }
  }

  std::vector<Deformation> deformations() {
    if (columns_.empty()) throw InputError(name_ + ": is empty, must have a header and rows");
    if (all_.empty()) throw InputError(name_ + ": has no rows after the header");
    return std::move(all_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  [[nodiscard]] bool has(std::size_t column) const {
    return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
  }

  void read_header(std::string_view line) {
    if (line.find(';') != std::string_view::npos) {
      fail("semicolons stand between the columns, must be commas, and points in the numbers");
    }
    split(line, cells_);
    double number = 0.0;
    if (parse_number(cells_.front(), number)) {
      fail("the header is missing: the first line must be r_mm,u_mm or depth_mm,r_mm,u_mm");
    }
    for (const std::string_view cell : cells_) {
      const auto known = std::find(kNames.begin(), kNames.end(), cell);
      if (known == kNames.end()) {
        const std::string near = nearest_word(cell, kNames);
        fail("column \"" + shown(cell) + "\": unknown, " +
             (near.empty() ? "known are r_mm, u_mm and depth_mm" : "did you mean " + near + "?"));
      }
      const auto column = static_cast<std::size_t>(known - kNames.begin());
      if (has(column)) fail(kNames[column] + ": stands twice, must stand once");
      columns_.push_back(column);
    }
    for (const std::size_t column : {kDistance, kDisplacement}) {
      if (!has(column)) fail(kNames[column] + ": missing, the header must name r_mm and u_mm");
    }
  }

  void read_row(std::string_view line) {
    split(line, cells_);
    if (cells_.size() != columns_.size()) {
      const bool decimal_comma = cells_.size() == 2 * columns_.size();
      fail("the row has " + std::to_string(cells_.size()) + " values, must have " +
           std::to_string(columns_.size()) + " as the header" +
           (decimal_comma ? "; a decimal comma must be a point" : ""));
    }
    std::array<double, kColumns> values{};
    for (std::size_t i = 0; i < cells_.size(); ++i) values[columns_[i]] = number(columns_[i], cells_[i]);
    if (has(kDepth) && !(values[kDepth] > 0.0)) {
      fail("depth_mm = " + shortest(values[kDepth]) + ": must be > 0");
    }
    Deformation& into = deformation_at(values[kDepth]);
    into.distance.push_back(values[kDistance] * kMillimetre);
    into.displacement.push_back(values[kDisplacement] * kMillimetre);
  }

  [[nodiscard]] double number(std::size_t column, std::string_view cell) const {
    constexpr double kLargest = 1e6;  // mm
    double value = 0.0;
    if (!parse_number(cell, value) || !std::isfinite(value) || std::abs(value) > kLargest) {
      fail(kNames[column] + " = " + shown(cell) + ": must be a finite number up to 1e6");
    }
    return value;
  }

  /// The deformation that a row belongs to, made when it is the first of its depth.
  Deformation& deformation_at(double depth_mm) {
    const auto [entry, made] = places_.try_emplace(depth_mm, all_.size());
    if (made) {
      if (all_.size() == kMostDepths) {
        fail("depth_mm = " + shortest(depth_mm) + ": more than " + std::to_string(kMostDepths) +
             " depths, is this the right column?");
      }
      all_.emplace_back();
      all_.back().name = stem_ + (has(kDepth) ? " at " + shortest(depth_mm) + " mm" : "");
      all_.back().depth = depth_mm * kMillimetre;
    }
    return all_[entry->second];
  }

  std::string name_;
  std::string stem_;
  std::size_t line_ = 0;
  std::vector<std::size_t> columns_;  // which column each cell of a row is
  std::vector<std::string_view> cells_;
  std::vector<Deformation> all_;
  std::map<double, std::size_t> places_;
};

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

/// Whether the displacement falls with the distance, by the sign of their covariance.
bool falls(const Deformation& deformation) {
  const auto n = static_cast<double>(deformation.size());
  double mean_r = 0.0;
  double mean_u = 0.0;
  for (std::size_t i = 0; i < deformation.size(); ++i) {
    mean_r += deformation.distance[i] / n;
    mean_u += deformation.displacement[i] / n;
  }
  double covariance = 0.0;
  for (std::size_t i = 0; i < deformation.size(); ++i) {
    covariance += (deformation.distance[i] - mean_r) * (deformation.displacement[i] - mean_u);
  }
  return covariance < 0.0;
}

}  // namespace

void check_deformation(Deformation& deformation, const std::string& where) {
  if (deformation.size() < kFewestPlaces) {
    throw InputError(where + ": has " + std::to_string(deformation.size()) +
                     (deformation.size() == 1 ? " row" : " rows") + ", must have at least " +
                     std::to_string(kFewestPlaces));
  }
  sort_by_distance(deformation);
  if (!(deformation.distance.back() > deformation.distance.front())) {
    throw InputError(where + ": r_mm is " + shortest(deformation.distance.front() / kMillimetre) +
                     " in every row, must change");
  }
  const auto [least, most] =
      std::minmax_element(deformation.displacement.begin(), deformation.displacement.end());
  if (!(*most > *least)) {
    throw InputError(where + ": u_mm is " + shortest(*least / kMillimetre) + " in every row, must change");
  }
  if (!falls(deformation) || !(*most > 0.0)) {
    throw InputError(where +
                     ": u_mm does not fall from the contact outwards; the way that the tool pushes or pulls "
                     "the surface counts positive");
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
  const std::string name = file.string();
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw InputError(name + ": there is no such file");
  if (std::filesystem::is_directory(file, status)) {
    throw InputError(name + ": is a folder, must be a CSV file");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(name + ": cannot be read");
  DeformationReader reader(name, file.stem().string());
  for (std::string line; std::getline(in, line);) reader.read_line(line);
  if (in.bad()) throw InputError(name + ": cannot be read to its end");
  std::vector<Deformation> all = reader.deformations();
  for (Deformation& deformation : all) {
    const bool several = all.size() > 1;
    check_deformation(deformation,
                      several ? name + ": depth_mm " + shortest(deformation.depth / kMillimetre) : name);
  }
  return all;
}

}  // namespace palpate::fit
