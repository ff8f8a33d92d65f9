#include "fit/identify/sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/system/json_text.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"
#include "run/tasks/for_each_task.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/intervals.h"
#include "fit/identify/least_squares.h"
#include "fit/identify/local_optima.h"
#include "fit/identify/profile_path.h"
#include "fit/identify/size_exponent.h"

namespace palpate::identify {
namespace {

using Json = nlohmann::ordered_json;

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
bool read_range(std::string_view text, double unit, ParameterSweep& request) {
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
         request.values >= kFewestSweepValues && request.values <= kMaxSweepValues;
}

/// A request as unambiguous text, for keys.
std::string text_of(const ParameterSweep& request) {
  const auto number = [](const std::optional<double>& value) { return value ? shortest(*value) : "-"; };
  return std::to_string(request.parameter) + '=' + number(request.low) + ':' + number(request.high) + ':' +
         std::to_string(request.values);
}

/// One half of a sweep: the values from the fit's value upwards, or those below it.
struct SweepPiece {
  std::size_t target = 0;  // index of the specimen; the number of specimens: pooled
  ParameterSweep request;
  bool upwards = true;
};

/// What is swept: the problem of one specimen, or the pooled problem, and its best fit.
class Target final {
 public:
  Target(std::size_t number, const std::vector<Specimen>& specimens, const ManyFits& fits,
         const Settings& settings)
      : pooled_(number == specimens.size()) {
    if (pooled_) {
      used_ = as_pooled(at_reference(specimens, fits.pooled.size), settings);
      problem_ = make_problem(settings, fits.pooled.terms, pooled_parts(used_));
      best_ = {fits.pooled.shared, fits.pooled.own};
      for (const SpecimenFit& fit : fits.specimens) {
        if (fit.terms == problem_.terms && others_.size() < kStarts)
          others_.push_back({fit.shared, fits.pooled.own});
      }
    } else {
      const SpecimenFit& fit = fits.specimens[number];
      used_ = {as_fitted(specimens[number], settings)};
      problem_ = make_problem(settings, fit.terms, {make_part(used_.front())});
      best_ = {fit.shared, {fit.own}};
      for (const Point& optimum : fit.local_optima) others_.push_back(solution_at(problem_, optimum));
    }
    set_loss(problem_, best_);
    best_.cost = cost_of(problem_, best_.shared, best_.own);
    best_costs_ = part_costs(problem_, best_);
    effective_ = limited_sample_size(effective_at(problem_, best_), used_.front().size(),
                                     best_.shared.size() + kOwnParameters);
  }

  Target(const Target&) = delete;  // problem_ points into used_
  Target& operator=(const Target&) = delete;

  /// The values of a piece [natural logarithms of SI values], from the fit's value outwards.
  [[nodiscard]] std::vector<double> values_of_piece(const SweepPiece& piece, const Interval& interval) const {
    const std::size_t index = piece.request.parameter;
    const double best = best_.shared[index];
    std::vector<double> values = requested(piece.request, interval);
    const double first = values.front();
    const double last = values.back();
    const auto add = [&](double value) {
      if (value >= first && value <= last) values.push_back(value);
    };
    add(best);
    for (const double end : {portable::log(interval.low), portable::log(interval.high)}) {
      const auto between = [&](double value) {
        return (value > best) == (end > best) && value != best &&
               std::abs(value - best) < std::abs(end - best);
      };
      if (std::none_of(values.begin(), values.end(), between)) add(0.5 * (best + end));
    }
    for (const Solution& other : others_) {
      if (!pooled_ && point_of(other, index).within_95) add(other.shared[index]);
    }
    std::erase_if(values, [&](double value) { return (value >= best) != piece.upwards; });
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    if (!piece.upwards) std::reverse(values.begin(), values.end());
    return values;
  }

  /// Profile at each of `values`: from the best fit outwards and from a search at each value (pooled: from
  /// each specimen's fit at the far end); then back and outwards again from the best of these.
  [[nodiscard]] std::vector<Solution> profile(std::size_t index, const std::vector<double>& values) {
    std::vector<Solution> found;
    for (const double value : values) {
      problem_.bounds.low[index] = std::min(problem_.bounds.low[index], value);
      problem_.bounds.high[index] = std::max(problem_.bounds.high[index], value);
      const bool own = value == best_.shared[index];
      found.push_back(own ? best_ : profile_at(problem_, found.empty() ? best_ : found.back(), index, value));
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool searched = !pooled_ || i + 1 == found.size();  // expensive for the pooled problem
      if (searched) search_at(index, values[i], found[i]);
    }
    for (std::size_t i = found.size(); i-- > 1;) {
      take_better(profile_at(problem_, found[i], index, values[i - 1]), found[i - 1]);
    }
    for (std::size_t i = 1; i < found.size(); ++i) {
      take_better(profile_at(problem_, found[i - 1], index, values[i]), found[i]);
    }
    return found;
  }

  [[nodiscard]] SweepPoint point_of(const Solution& solution, std::size_t index) const {
    const Point none(kOwnParameters, 0.0);
    SweepPoint point;
    point.others = values_of(solution.shared, none, {});
    point.others.resize(shared_count(problem_.terms));
    point.value = point.others[index];
    point.nrmse = nrmse_of(solution);
    if (pooled_) {
      point.deviance = std::numeric_limits<double>::quiet_NaN();
      point.within_95 = in_confidence_set(best_costs_, part_costs(problem_, solution));
    } else {
      const double t = likelihood_limit(effective_, shared_count(problem_.terms) + kOwnParameters);
      point.deviance = 2.0 * (log_posterior_of(problem_, best_, effective_) -
                              log_posterior_of(problem_, solution, effective_));
      point.within_95 = point.deviance <= t * t;
    }
    return point;
  }

  [[nodiscard]] double best_nrmse() const { return nrmse_of(best_); }
  [[nodiscard]] bool clearly_better(const Solution& solution) const {
    constexpr double kClearlyBetter = 0.99;  // times the best fit's sum of squares
    return solution.cost < kClearlyBetter * best_.cost;
  }

 private:
  static constexpr std::size_t kStarts = 4;

  /// The requested values, increasing; by default around the interval.
  [[nodiscard]] std::vector<double> requested(const ParameterSweep& request, const Interval& interval) const {
    constexpr double kBeside = 1.01;  // least factor between values
    const double beside = std::max(kBeside, std::sqrt(interval.high / interval.low));
    const std::size_t i = request.parameter;
    const double low = request.low ? portable::log(*request.low)
                                   : std::max(portable::log(interval.low / beside), problem_.bounds.low[i]);
    const double high = request.high
                            ? portable::log(*request.high)
                            : std::min(portable::log(interval.high * beside), problem_.bounds.high[i]);
    std::vector<double> values;
    for (std::size_t n = 0; n < request.values; ++n) {
      values.push_back(low + static_cast<double>(n) / static_cast<double>(request.values - 1) * (high - low));
    }
    return values;
  }

  /// Replaces `kept` by the result of a search with the parameter held at `value`, when it is better.
  void search_at(std::size_t index, double value, Solution& kept) const {
    constexpr int kSteps = 60;
    const Point relaxation(best_.shared.begin() + kLawParameters, best_.shared.end());
    for (Solution start :
         pooled_ ? others_ : multistart_points_at(problem_, index, value, relaxation, kStarts)) {
      start.shared[index] = value;
      take_better(solve(problem_, start, kSteps, static_cast<int>(index)), kept);
    }
  }

  static void take_better(Solution found, Solution& kept) {
    if (found.cost < kept.cost) kept = std::move(found);
  }

  /// Root mean square over the specimens of their errors, each relative to its force range.
  [[nodiscard]] double nrmse_of(const Solution& solution) const {
    double shares = 0.0;
    for (std::size_t p = 0; p < used_.size(); ++p) {
      const std::vector<double> left =
          plain_residuals(problem_, problem_.parts[p], solution.shared, solution.own[p]);
      shares +=
          std::inner_product(left.begin(), left.end(), left.begin(), 0.0) / static_cast<double>(left.size());
    }
    return std::sqrt(shares / static_cast<double>(used_.size()));
  }

  bool pooled_;
  std::vector<Specimen> used_;
  Problem problem_;
  Solution best_;
  std::vector<double> best_costs_;
  std::vector<Solution> others_;  // local optima of the fit; pooled: the fits of single specimens
  double effective_ = 0.0;
};

Json sweep_point_json(const SweepPoint& point) {
  Json json = Json::array({point.value, number_json(point.nrmse), point.within_95 ? 1.0 : 0.0});
  json.push_back(number_json(point.deviance));
  for (const double value : point.others) json.push_back(value);
  return json;
}

/// Must be > 0: reports plot it on a logarithmic axis.
double parameter_of_json(const Json& json) {
  const auto value = json.get<double>();
  if (!(value > 0.0)) {
    throw InputError("sweep's line: a parameter is " + json.dump() + ", want a number > 0");
  }
  return value;
}

SweepPoint point_of_json(const Json& json) {
  constexpr std::size_t kOthers = 4;  // parameters begin at this index
  SweepPoint point;
  point.value = parameter_of_json(json.at(0));
  point.nrmse = number_of(json.at(1));
  point.within_95 = json.at(2).get<double>() > 0.5;
  point.deviance = number_of(json.at(3));
  for (std::size_t i = kOthers; i < json.size(); ++i) {
    const bool law = i < kOthers + kLawParameters;  // else a relaxation parameter
    point.others.push_back(law ? parameter_of_json(json.at(i)) : json.at(i).get<double>());
  }
  if (point.others.size() < kLawParameters) throw InputError("sweep's line: a point lacks parameters");
  return point;
}

/// Computes a piece. Returns one line of JSON without line end, bit for bit exact.
std::string sweep_line(const SweepPiece& piece, const std::string& key,
                       const std::vector<Specimen>& specimens, const ManyFits& fits,
                       const Settings& settings) {
  const std::size_t index = piece.request.parameter;
  Target target(piece.target, specimens, fits, settings);
  const std::vector<Estimate>& estimates =
      piece.target == specimens.size() ? fits.pooled.estimates : fits.specimens[piece.target].estimates;
  Json points = Json::array();
  bool better = false;
  for (const Solution& solution :
       target.profile(index, target.values_of_piece(piece, estimates[index].interval))) {
    better = better || target.clearly_better(solution);
    points.push_back(sweep_point_json(target.point_of(solution, index)));
  }
  const Json json = {{"key", key},
                     {"best_nrmse", target.best_nrmse()},
                     {"found_better", better},
                     {"values", points.size()},
                     {"points_swept", std::move(points)}};
  return json.dump();
}

/// Both halves of every request, for each specimen and, with several specimens, for the pooled fit.
std::vector<SweepPiece> pieces_of(const std::vector<ParameterSweep>& requests, std::size_t specimens) {
  std::vector<SweepPiece> pieces;
  for (std::size_t target = 0; target < (specimens > 1 ? specimens + 1 : 1); ++target) {
    for (const ParameterSweep& request : requests) {
      for (const bool upwards : {false, true}) pieces.push_back({target, request, upwards});
    }
  }
  return pieces;
}

/// @throws InputError when a request lies more than 1000 times beyond the bounds of the specimens' fits.
void check_ranges(const std::vector<ParameterSweep>& requests, const std::vector<Specimen>& specimens,
                  const Settings& settings) {
  constexpr double kBeyond = 1e3;
  std::vector<Part> parts;
  for (const Specimen& specimen : specimens) parts.push_back(make_part(specimen));
  const Bounds bounds = make_problem(settings, 0, std::move(parts)).bounds;
  for (const ParameterSweep& request : requests) {
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

std::string name_of(const SweepPiece& piece, const std::vector<Specimen>& specimens) {
  const bool pooled = piece.target == specimens.size();
  return (pooled ? "all together" : specimens[piece.target].name) + ": " +
         labels(0)[piece.request.parameter].name;
}

/// A sweep from the lines of both halves. @throws InputError when they lack points
Sweep joined(const SweepPiece& piece, const std::string& below, const std::string& above,
             const std::vector<Specimen>& specimens, const ManyFits& fits, const std::string& results_file) {
  Sweep sweep;
  sweep.parameter = piece.request.parameter;
  if (piece.target == specimens.size()) {
    sweep.terms = fits.pooled.terms;
    sweep.best = fits.pooled.estimates[sweep.parameter].value;
  } else {
    sweep.specimen = specimens[piece.target].name;
    sweep.terms = fits.specimens[piece.target].terms;
    sweep.best = fits.specimens[piece.target].estimates[sweep.parameter].value;
  }
  add_sweep_line(below, sweep);
  add_sweep_line(above, sweep);
  if (sweep.points.size() < piece.request.values) {
    throw InputError(
        fmt::format("{}: the sweep of {} has {} points, must have {}: delete the file to repeat the sweep",
                    results_file, name_of(piece, specimens), sweep.points.size(), piece.request.values));
  }
  std::stable_sort(sweep.points.begin(), sweep.points.end(),
                   [](const SweepPoint& a, const SweepPoint& b) { return a.value < b.value; });
  sweep.open_below = sweep.points.front().within_95;
  sweep.open_above = sweep.points.back().within_95;
  return sweep;
}

}  // namespace

void add_sweep_line(const std::string& line, Sweep& sweep) {
  try {
    const Json json = parse_json(line);
    sweep.best_nrmse = json.at("best_nrmse").get<double>();
    sweep.found_better = sweep.found_better || json.at("found_better").get<bool>();
    const Json& points = json.at("points_swept");
    if (points.size() < whole_number<std::size_t>(json, "values")) {
      throw InputError("sweep's line: has fewer points than values");
    }
    for (const Json& point : points) sweep.points.push_back(point_of_json(point));
  } catch (const Json::exception& error) {
    throw InputError(std::string("sweep's line: ") + error.what());
  }
}

std::vector<ParameterSweep> sweep_requests(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::vector<ParameterLabel> names = labels(0);
  std::vector<ParameterSweep> requests;
  for (std::size_t i = 0; i < kLawParameters; ++i) {
    if (name != names[i].name && name != "all") continue;
    ParameterSweep request;
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
                  const std::vector<ParameterSweep>& requests, const Settings& settings,
                  tasks::Communicator& ranks, const std::string& results_file, const Progress& progress) {
  if (ranks.size() > 1) {
    specimens = specimens_of(ranks.broadcast(ranks.rank() == 0 ? bytes_of(specimens) : std::string()));
  }
  if (specimens.empty() || specimens.size() != fits.specimens.size()) {
    throw InputError("sweep: needs at least one specimen, and a fit of each");
  }
  check_ranges(requests, specimens, settings);
  const std::vector<SweepPiece> pieces = pieces_of(requests, specimens.size());
  const auto key = [&](std::size_t i) {
    return sweep_record_key(text_of(pieces[i].request), 2 * pieces[i].target + (pieces[i].upwards ? 1 : 0),
                            specimens, settings);
  };
  const auto run = [&](std::size_t i) { return sweep_line(pieces[i], key(i), specimens, fits, settings); };
  std::size_t done = 0;
  const auto arrived = [&](std::size_t i) {
    if (!progress) return;
    progress(static_cast<double>(++done) / static_cast<double>(pieces.size()), name_of(pieces[i], specimens));
  };
  if (progress && ranks.rank() == 0) progress(0.0, "sweeps");
  tasks::Record record(results_file, ranks, check_line);
  const auto [lines, resumed] = for_each_task(&ranks, {pieces.size(), run, key, arrived, true}, &record);
  Sweeps sweeps;
  sweeps.resumed = resumed;
  for (std::size_t i = 0; i < pieces.size(); i += 2) {
    sweeps.all.push_back(joined(pieces[i], lines[i], lines[i + 1], specimens, fits, results_file));
  }
  return sweeps;
}

}  // namespace palpate::identify
