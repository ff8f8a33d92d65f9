#include "fit/identify/sweep_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <nlohmann/json.hpp>

#include "core/base/portable_math.h"
#include "core/base/statistics.h"
#include "io/system/json_text.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/intervals.h"
#include "fit/identify/local_optima.h"
#include "fit/identify/profile_path.h"

namespace palpate::identify {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kClearlyBetter = 0.99;  // times the best fit's sum of squares

/// What is swept: the problem of one specimen, or the pooled problem, and its best fit.
class Target final {
 public:
  Target(std::size_t number, const std::vector<Specimen>& specimens, const ManyFits& fits,
         const Settings& settings)
      : pooled_(number == specimens.size()) {
    if (pooled_) {
      used_ = as_pooled(specimens);
      problem_ = make_problem(settings, fits.pooled.terms, pooled_parts(used_));
      best_ = {fits.pooled.shared, fits.pooled.own};
      for (const SpecimenFit& fit : fits.specimens) {
        if (fit.terms == problem_.terms && more_.size() < kStarts)
          more_.push_back({fit.shared, fits.pooled.own});
      }
    } else {
      const SpecimenFit& fit = fits.specimens[number];
      used_ = {as_fitted(specimens[number], settings)};
      problem_ = make_problem(settings, fit.terms, {make_part(used_.front())});
      best_ = {fit.shared, {fit.own}};
      for (const Point& minimum : fit.local_optima) {
        const auto own = minimum.end() - static_cast<std::ptrdiff_t>(kOwnParameters);
        optima_.push_back({Point(minimum.begin(), own), {Point(own, minimum.end())}});
      }
    }
    set_loss(problem_, best_);
    best_.cost = cost_of(problem_, best_.shared, best_.own);
    best_costs_ = part_costs(problem_, best_);
    for (std::size_t p = 0; p < used_.size(); ++p) {
      effective_ +=
          effective_sample_size(plain_residuals(problem_, problem_.parts[p], best_.shared, best_.own[p]));
    }
    effective_ = limited_sample_size(effective_, used_.front().size(), best_.shared.size() + kOwnParameters);
  }

  Target(const Target&) = delete;  // problem_ points into used_
  Target& operator=(const Target&) = delete;

  [[nodiscard]] const Solution& best() const noexcept { return best_; }
  [[nodiscard]] const Bounds& bounds() const noexcept { return problem_.bounds; }
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

  /// Fits with a parameter held at each of `values` [logarithms]. Starts: outwards from the best fit, from
  /// the fit's other local optima, and from a search at each value (pooled: from each specimen's fit at the
  /// far end); then back and outwards again from the best of these.
  [[nodiscard]] std::vector<Solution> along(std::size_t index, const std::vector<double>& values) {
    std::vector<Solution> found;
    for (const double value : values) {
      problem_.bounds.low[index] = std::min(problem_.bounds.low[index], value);
      problem_.bounds.high[index] = std::max(problem_.bounds.high[index], value);
      const bool own = value == best_.shared[index];
      found.push_back(own ? best_ : profile_at(problem_, found.empty() ? best_ : found.back(), index, value));
    }
    for (const Solution& minimum : optima_) {
      if (found.empty()) break;
      const std::size_t i = nearest(values, minimum.shared[index]);
      take_better(profile_at(problem_, minimum, index, values[i]), found[i]);
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
    free_stuck(index, values, found);
    return found;
  }

  /// Fits between the best one and `value`, which is outside the confidence set, closer and closer until one
  /// is inside.
  [[nodiscard]] std::vector<Solution> nearer(std::size_t index, double value) const {
    constexpr int kMost = 8;
    const double best = best_.shared[index];
    std::vector<Solution> found;
    for (int n = 0; n < kMost && (found.empty() || !point_of(found.back(), index).within_95); ++n) {
      value = 0.5 * (best + value);
      found.push_back(profile_at(problem_, best_, index, value));
    }
    return found;
  }

  /// Fits at intermediate values: where a value is better than both neighbours but outside the confidence
  /// set, the best of more values on either side, if that one is inside.
  [[nodiscard]] std::vector<Solution> between(std::size_t index, const std::vector<double>& values,
                                              const std::vector<Solution>& found) const {
    std::vector<Solution> left;
    for (std::size_t i = 1; i + 1 < found.size(); ++i) {
      const bool dip = found[i].cost < found[i - 1].cost && found[i].cost < found[i + 1].cost;
      if (!dip || point_of(found[i], index).within_95) continue;
      Solution lowest = found[i];
      for (const double end : {values[i - 1], values[i + 1]}) {
        for (const double share : {0.2, 0.4, 0.6, 0.8}) {
          const double value = values[i] + share * (end - values[i]);
          Solution tried = profile_at(problem_, found[i], index, value);
          search_at(index, value, tried);
          take_better(std::move(tried), lowest);
        }
      }
      if (point_of(lowest, index).within_95) left.push_back(std::move(lowest));
    }
    return left;
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
      point.deviance = 2.0 * (posterior_of(best_) - posterior_of(solution));
      point.within_95 = point.deviance <= t * t;
    }
    return point;
  }

 private:
  static constexpr std::size_t kStarts = 4;
  static constexpr int kSteps = 60;

  static std::size_t nearest(const std::vector<double>& values, double wanted) {
    const auto found = std::min_element(values.begin(), values.end(), [wanted](double a, double b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    return static_cast<std::size_t>(found - values.begin());
  }

  /// Replaces `kept` by the result of a search with the parameter held at `value`, when it is better.
  void search_at(std::size_t index, double value, Solution& kept) const {
    const Point relaxation(best_.shared.begin() + kLawParameters, best_.shared.end());
    for (Solution start :
         pooled_ ? more_ : multistart_points_at(problem_, index, value, relaxation, kStarts)) {
      start.shared[index] = value;
      take_better(solve(problem_, start, kSteps, static_cast<int>(index)), kept);
    }
  }

  /// A fit with a higher cost than both neighbours is stuck in a local optimum: fits it again from each
  /// neighbour's parameters.
  void free_stuck(std::size_t index, const std::vector<double>& values, std::vector<Solution>& found) const {
    for (std::size_t i = 1; i + 1 < found.size(); ++i) {
      if (!(found[i].cost > std::max(found[i - 1].cost, found[i + 1].cost))) continue;
      for (Solution start : {found[i - 1], found[i + 1]}) {
        start.shared[index] = values[i];
        take_better(solve(problem_, start, kSteps, static_cast<int>(index)), found[i]);
      }
    }
  }

  static void take_better(Solution found, Solution& kept) {
    if (found.cost < kept.cost) kept = std::move(found);
  }

  [[nodiscard]] double posterior_of(const Solution& solution) const {
    return log_posterior_of(problem_, solution, effective_);
  }

  bool pooled_;
  std::vector<Specimen> used_;
  Problem problem_;
  Solution best_;
  std::vector<double> best_costs_;
  std::vector<Solution> more_;    // pooled: the fits of single specimens
  std::vector<Solution> optima_;  // local optima of the fit other than the best
  double effective_ = 0.0;
};

Json point_json(const SweepPoint& point) {
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

}  // namespace

std::vector<double> sweep_values(const SweepRequest& request, const Estimate& estimate,
                                 const Bounds& bounds) {
  constexpr double kBeside = 1.01;  // least factor between values
  const Interval& interval = estimate.interval;
  const double beside = std::max(kBeside, std::sqrt(interval.high / interval.low));
  const std::size_t i = request.parameter;
  const double lowest = std::max(portable::log(interval.low / beside), bounds.low[i]);
  const double highest = std::min(portable::log(interval.high * beside), bounds.high[i]);
  const double low = request.low ? portable::log(*request.low) : lowest;
  const double high = request.high ? portable::log(*request.high) : highest;
  std::vector<double> values;
  for (std::size_t n = 0; n < request.values; ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(request.values - 1);
    values.push_back(low + share * (high - low));
  }
  return values;
}

std::string sweep_line(const SweepPiece& piece, const std::string& key,
                       const std::vector<Specimen>& specimens, const ManyFits& fits,
                       const Settings& settings) {
  const std::size_t index = piece.request.parameter;
  const bool pooled = piece.target == specimens.size();
  Target target(piece.target, specimens, fits, settings);
  const Estimate& estimate =
      pooled ? fits.pooled.estimates[index] : fits.specimens[piece.target].estimates[index];
  const double best = target.best().shared[index];
  const std::vector<double> all = sweep_values(piece.request, estimate, target.bounds());
  const bool across = best >= all.front() && best <= all.back();  // then the fit's own value is included
  std::vector<double> values;
  if (across && piece.upwards) values.push_back(best);
  for (const double value : all) {
    if (value != best && (value > best) == piece.upwards) values.push_back(value);
  }
  if (!piece.upwards) std::reverse(values.begin(), values.end());
  Json points = Json::array();
  bool better = false;
  std::vector<Solution> found = target.along(index, values);
  const std::vector<Solution> between = target.between(index, values, found);
  const std::size_t beside = across && piece.upwards ? 1 : 0;
  if (across && found.size() > beside && !target.point_of(found[beside], index).within_95) {
    const std::vector<Solution> nearer = target.nearer(index, values[beside]);
    found.insert(found.end(), nearer.begin(), nearer.end());
  }
  found.insert(found.end(), between.begin(), between.end());
  for (const Solution& solution : found) {
    better = better || solution.cost < kClearlyBetter * target.best().cost;
    points.push_back(point_json(target.point_of(solution, index)));
  }
  const Json json = {{"key", key},
                     {"best_nrmse", target.nrmse_of(target.best())},
                     {"found_better", better},
                     {"values", values.size()},
                     {"points_swept", std::move(points)}};
  return json.dump();
}

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

}  // namespace palpate::identify
