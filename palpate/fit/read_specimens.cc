#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/base/units.h"
#include "palpate/fit/csv_text.h"
#include "palpate/fit/specimen.h"

namespace palpate::fit {
namespace {

enum Column : std::size_t { kTime, kDisplacement, kForce, kSpecimen, kColumns };

const std::array<std::string, kColumns> kNames = {"time_s", "displacement_mm", "force_N", "specimen"};
constexpr std::size_t kMostSpecimens = 10'000;  // of one file; more is a mistaken column

/// Reads one file line by line; every error is FILE:LINE: column = value: what would be right.
class SpecimenReader final {
 public:
  SpecimenReader(std::string name, std::string stem) : name_(std::move(name)), stem_(std::move(stem)) {}

  [[nodiscard]] bool has_header() const { return !columns_.empty(); }
  void next_line() { ++line_; }
  [[nodiscard]] bool at_first_line() const { return line_ == 1; }

  void read_header(std::string_view line) {
    if (line.find(';') != std::string_view::npos) {
      fail("semicolons stand between the columns, must be commas, and points in the numbers");
    }
    split(line, cells_);
    double number = 0.0;
    if (parse_number(cells_.front(), number)) {
      fail(
          "the header is missing: the first line must be displacement_mm,force_N or "
          "time_s,displacement_mm,force_N");
    }
    for (const std::string_view cell : cells_) {
      const auto known = std::find(kNames.begin(), kNames.end(), cell);
      if (known == kNames.end()) fail_unknown(cell);
      const auto column = static_cast<std::size_t>(known - kNames.begin());
      if (has(column)) fail(kNames[column] + ": stands twice, must stand once");
      columns_.push_back(column);
    }
    for (const std::size_t column : {kDisplacement, kForce}) {
      if (!has(column)) {
        fail(kNames[column] + ": missing, the header must name displacement_mm and force_N");
      }
    }
    timed_ = has(kTime);
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
    std::string_view specimen;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (columns_[i] == kSpecimen) {
        specimen = cells_[i];
        if (specimen.empty()) fail("specimen: empty, must be a name");
      } else {
        values[columns_[i]] = number(columns_[i], cells_[i]);
      }
    }
    Specimen& into = specimen_named(specimen);
    if (timed_) {
      if (!into.time.empty() && !(values[kTime] > into.time.back())) {
        fail("time_s = " + shortest(values[kTime]) + ": must be later than the row before, " +
             shortest(into.time.back()));
      }
      into.time.push_back(values[kTime]);
    }
    into.displacement.push_back(values[kDisplacement] * kMillimetre);
    into.force.push_back(values[kForce]);
  }

  std::vector<Specimen> specimens() {
    if (!has_header()) throw InputError(name_ + ": is empty, must have a header and rows");
    if (all_.empty()) throw InputError(name_ + ": has no rows after the header");
    return std::move(all_);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + what);
  }

 private:
  [[nodiscard]] bool has(std::size_t column) const {
    return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
  }

  [[noreturn]] void fail_unknown(std::string_view cell) const {
    const std::string near = nearest_word(cell, kNames);
    fail("column \"" + shown(cell) + "\": unknown, " +
         (near.empty() ? "known are time_s, displacement_mm, force_N and specimen"
                       : "did you mean " + near + "?"));
  }

  [[nodiscard]] double number(std::size_t column, std::string_view cell) const {
    constexpr double kLargest = 1e9;  // mm, N or s: beyond it squares of sums would lose their meaning
    double value = 0.0;
    if (!parse_number(cell, value) || !std::isfinite(value) || std::abs(value) > kLargest) {
      fail(kNames[column] + " = " + shown(cell) + ": must be a finite number up to 1e9");
    }
    return value;
  }

  /// The specimen that a row belongs to, made when it is the first.
  Specimen& specimen_named(std::string_view cell) {
    if (!all_.empty() && cell == last_cell_) return all_[last_];
    const auto [entry, made] = places_.try_emplace(std::string(cell), all_.size());
    if (made) {
      if (all_.size() == kMostSpecimens) {
        fail("specimen = " + shown(cell) + ": more than " + std::to_string(kMostSpecimens) +
             " specimens, is this the right column?");
      }
      all_.emplace_back();
      all_.back().name = shown(cell.empty() ? std::string_view(stem_) : cell);
    }
    last_cell_ = entry->first;
    last_ = entry->second;
    return all_[last_];
  }

  std::string name_;
  std::string stem_;
  std::size_t line_ = 0;
  bool timed_ = false;
  std::vector<std::size_t> columns_;  // which column each cell of a row is
  std::vector<std::string_view> cells_;
  std::vector<Specimen> all_;
  std::map<std::string, std::size_t, std::less<>> places_;
  std::string last_cell_;
  std::size_t last_ = 0;
};

/// Pearson's correlation of displacement and force.
double correlation(const Specimen& s) {
  const auto n = static_cast<double>(s.size());
  double mean_d = 0.0;
  double mean_f = 0.0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    mean_d += s.displacement[i] / n;
    mean_f += s.force[i] / n;
  }
  double dd = 0.0;
  double ff = 0.0;
  double df = 0.0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double d = s.displacement[i] - mean_d;
    const double f = s.force[i] - mean_f;
    dd += d * d;
    ff += f * f;
    df += d * f;
  }
  return df / std::sqrt(dd * ff);
}

/// Refuses what no law could be fitted to. @param where file and specimen, for the message
void check(const Specimen& s, const std::string& where) {
  if (s.size() < kFewestPoints) {
    throw InputError(where + ": has " + std::to_string(s.size()) + (s.size() == 1 ? " row" : " rows") +
                     ", must have at least " + std::to_string(kFewestPoints));
  }
  const auto [low, high] = std::minmax_element(s.displacement.begin(), s.displacement.end());
  const auto [weak, strong] = std::minmax_element(s.force.begin(), s.force.end());
  if (!(*high > *low)) {
    throw InputError(where + ": displacement_mm is " + shortest(*low / kMillimetre) +
                     " in every row, must change");
  }
  if (!(*strong > *weak)) {
    throw InputError(where + ": force_N is " + shortest(*weak) + " in every row, must change");
  }
  if (*high <= 0.0) {
    throw InputError(where +
                     ": displacement_mm is never above 0; pressing in and pulling out both count "
                     "positive, with --direction for which");
  }
  if (!(correlation(s) > 0.0)) {
    throw InputError(where +
                     ": force_N falls as displacement_mm rises; pressing in and pulling out both "
                     "count positive, with --direction for which");
  }
}

}  // namespace

std::vector<Specimen> read_specimens(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw InputError(name + ": there is no such file");
  if (std::filesystem::is_directory(file, status)) {
    throw InputError(name + ": is a folder, must be a CSV file");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(name + ": cannot be read");
  SpecimenReader reader(name, file.stem().string());
  for (std::string line; std::getline(in, line);) {
    reader.next_line();
    if (reader.at_first_line() && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    const std::string_view text = trimmed(line);
    if (text.empty() || text.starts_with('#')) continue;
    if (reader.has_header()) {
      reader.read_row(text);
    } else {
      reader.read_header(text);
    }
  }
  if (in.bad()) throw InputError(name + ": cannot be read to its end");
  std::vector<Specimen> all = reader.specimens();
  for (const Specimen& specimen : all) {
    check(specimen, all.size() == 1 ? name : name + ": specimen " + specimen.name);
  }
  return all;
}

}  // namespace palpate::fit
