#include "fit/identify/sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "run/tasks/for_each_task.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/least_squares.h"
#include "fit/identify/sweep_piece.h"

namespace palpate::identify {
namespace {

constexpr const char* kWanted =
    ": must be k1_N_per_m, beta, q, limit_mm or all, and after it nothing or =LOW:HIGH or =LOW:HIGH:N with "
    "0 < LOW < HIGH and N from 3 to 1000, e.g. q=0.5:0.9:21";

[[noreturn]] void refuse(const std::string& flag, const std::string& text) {
  throw InputError(flag + ' ' + text + kWanted);
}

/// Parses all of `text` as a number.
template <typename Number>
bool read(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Parses LOW:HIGH or LOW:HIGH:N in the parameter's unit; false when the form is wrong.
bool read_range(std::string_view text, double unit, SweepRequest& request) {
  const std::size_t first = text.find(':');
  if (first == std::string_view::npos) return false;
  const std::size_t second = text.find(':', first + 1);
  double low = 0.0;
  double high = 0.0;
  if (!read(text.substr(0, first), low) || !read(text.substr(first + 1, second - first - 1), high))
    return false;
  if (second != std::string_view::npos && !read(text.substr(second + 1), request.values)) return false;
  request.low = low * unit;
  request.high = high * unit;
  return *request.low > 0.0 && *request.low < *request.high && std::isfinite(*request.high) &&
         request.values >= kFewestSweepValues && request.values <= kMostSweepValues;
}

/// A request as unambiguous text, for keys.
std::string text_of(const SweepRequest& request) {
  const auto number = [](const std::optional<double>& value) { return value ? shortest(*value) : "-"; };
  return std::to_string(request.parameter) + '=' + number(request.low) + ':' + number(request.high) + ':' +
         std::to_string(request.values);
}

/// Both halves of every request, for each specimen and, with several specimens, for the pooled fit.
std::vector<SweepPiece> pieces_of(const std::vector<SweepRequest>& requests, std::size_t specimens) {
  std::vector<SweepPiece> pieces;
  for (std::size_t target = 0; target < (specimens > 1 ? specimens + 1 : 1); ++target) {
    for (const SweepRequest& request : requests) {
      for (const bool upwards : {false, true}) pieces.push_back({target, request, upwards});
    }
  }
  return pieces;
}

/// @throws InputError when a request lies more than 1000 times beyond the bounds of the specimens' fits.
void check_ranges(const std::vector<SweepRequest>& requests, const std::vector<Specimen>& specimens,
                  const Settings& settings) {
  constexpr double kBeyond = 1e3;
  std::vector<Part> parts;
  for (const Specimen& specimen : specimens) parts.push_back(make_part(specimen));
  const Bounds bounds = make_problem(settings, 0, std::move(parts)).bounds;
  for (const SweepRequest& request : requests) {
    const double low = portable::exp(bounds.low[request.parameter]) / kBeyond;
    const double high = portable::exp(bounds.high[request.parameter]) * kBeyond;
    if (request.low.value_or(low) >= low && request.high.value_or(high) <= high) continue;
    const ParameterLabel label = labels(0)[request.parameter];
    throw InputError(fmt::format(
        "--sweep {}={}:{}: must lie between {} and {}, 1000 times beyond what a fit of these data searches",
        label.name, shortest(*request.low / label.unit), shortest(*request.high / label.unit),
        shortest(low / label.unit), shortest(high / label.unit)));
  }
}

class Sweeping final {
 public:
  Sweeping(std::vector<Specimen> specimens, const ManyFits& fits, const std::vector<SweepRequest>& requests,
           const Settings& settings)
      : specimens_(std::move(specimens)),
        fits_(fits),
        settings_(settings),
        pieces_(pieces_of(requests, specimens_.size())) {}

  [[nodiscard]] Sweeps compute(tasks::Communicator& ranks, const std::string& results_file,
                               const Progress& progress) const {
    std::size_t done = 0;
    const auto key = [&](std::size_t i) { return key_of_piece(i); };
    const auto run = [&](std::size_t i) {
      return sweep_line(pieces_[i], key(i), specimens_, fits_, settings_);
    };
    const auto arrived = [&](std::size_t i) {
      if (!progress) return;
      progress(static_cast<double>(++done) / static_cast<double>(pieces_.size()), name_of(pieces_[i]));
    };
    if (progress && ranks.rank() == 0) progress(0.0, "sweeps");
    tasks::Record record(results_file, ranks, check_line);
    const auto [lines, resumed] = for_each_task(&ranks, {pieces_.size(), run, key, arrived}, &record);
    Sweeps sweeps;
    sweeps.resumed = resumed;
    for (std::size_t i = 0; i < pieces_.size(); i += 2) {
      const SweepPiece& piece = pieces_[i];
      const bool pooled = piece.target == specimens_.size();
      Sweep sweep;
      if (!pooled) sweep.specimen = specimens_[piece.target].name;
      sweep.parameter = piece.request.parameter;
      sweep.terms = pooled ? fits_.pooled.terms : fits_.specimens[piece.target].terms;
      sweep.best =
          (pooled ? fits_.pooled.estimates : fits_.specimens[piece.target].estimates)[sweep.parameter].value;
      add_sweep_line(lines[i], sweep);
      add_sweep_line(lines[i + 1], sweep);
      if (sweep.points.size() < piece.request.values) {
        throw InputError(fmt::format(
            "{}: the sweep of {} has {} points, must have {}: delete the file to repeat the sweep",
            results_file, name_of(piece), sweep.points.size(), piece.request.values));
      }
      std::stable_sort(sweep.points.begin(), sweep.points.end(),
                       [](const SweepPoint& a, const SweepPoint& b) { return a.value < b.value; });
      sweep.open_below = sweep.points.front().within_95;
      sweep.open_above = sweep.points.back().within_95;
      sweeps.all.push_back(std::move(sweep));
    }
    return sweeps;
  }

 private:
  [[nodiscard]] std::string key_of_piece(std::size_t i) const {
    return sweep_record_key(text_of(pieces_[i].request), 2 * pieces_[i].target + (pieces_[i].upwards ? 1 : 0),
                            specimens_, settings_);
  }

  [[nodiscard]] std::string name_of(const SweepPiece& piece) const {
    const std::string whose =
        piece.target == specimens_.size() ? "all together" : specimens_[piece.target].name;
    return whose + ": " + labels(0)[piece.request.parameter].name;
  }

  std::vector<Specimen> specimens_;
  const ManyFits& fits_;
  const Settings& settings_;
  std::vector<SweepPiece> pieces_;
};

}  // namespace

std::vector<SweepRequest> sweep_requests(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::vector<ParameterLabel> names = labels(0);
  std::vector<SweepRequest> requests;
  for (std::size_t i = 0; i < kLawParameters; ++i) {
    if (name != names[i].name && name != "all") continue;
    SweepRequest request;
    request.parameter = i;
    const bool ranged = equals != std::string::npos;
    const bool one_range_for_all = ranged && name == "all";  // their units differ
    if (one_range_for_all || (ranged && !read_range(text.substr(equals + 1), names[i].unit, request))) {
      refuse(flag, text);
    }
    requests.push_back(request);
  }
  if (requests.empty()) refuse(flag, text);
  return requests;
}

Sweeps sweep_many(std::vector<Specimen> specimens, const ManyFits& fits,
                  const std::vector<SweepRequest>& requests, const Settings& settings,
                  tasks::Communicator& ranks, const std::string& results_file, const Progress& progress) {
  if (ranks.size() > 1) {
    specimens = specimens_of(ranks.broadcast(ranks.rank() == 0 ? bytes_of(specimens) : std::string()));
  }
  if (specimens.empty() || specimens.size() != fits.specimens.size()) {
    throw InputError("sweep: needs at least one specimen, and a fit of each");
  }
  check_ranges(requests, specimens, settings);
  return Sweeping(std::move(specimens), fits, requests, settings).compute(ranks, results_file, progress);
}

}  // namespace palpate::identify
