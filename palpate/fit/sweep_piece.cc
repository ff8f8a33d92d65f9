#include "palpate/fit/sweep_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <nlohmann/json.hpp>

#include "palpate/base/error.h"
#include "palpate/base/portable_math.h"
#include "palpate/fit/ensemble.h"
#include "palpate/fit/intervals.h"
#include "palpate/fit/minima.h"
#include "palpate/fit/parts.h"
#include "palpate/fit/starts.h"
#include "palpate/fit/valley.h"

namespace palpate::fit {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kClearlyBetter = 0.99;  // of the best fit's sum of squares

/// What is swept: the problem of one specimen, or of all, and its best fit.
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
        if (fit.terms == problem_.terms) more_.push_back({fit.shared, fits.pooled.own});
      }
    } else {
      const SpecimenFit& fit = fits.specimens[number];
      used_ = {as_fitted(specimens[number], settings)};
      problem_ = make_problem(settings, fit.terms, {make_part(used_.front())});
      best_ = {fit.shared, {fit.own}};
      more_ = starts(problem_, kStarts);
    }
    set_loss(problem_, best_);
    best_.cost = cost_of(problem_, best_.shared, best_.own);
    best_costs_ = part_costs(problem_, best_);
    for (std::size_t p = 0; p < used_.size(); ++p) {
      effective_ += effective_count(plain_residuals(problem_, problem_.parts[p], best_.shared, best_.own[p]));
    }
    effective_ = trusted_count(effective_, used_.front().size(), best_.shared.size() + kOwnParameters);
  }

  Target(const Target&) = delete;  // the problem points into used_
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

  /// The fits with a parameter at `values` [logarithms], from the best one outwards, and back from what a
  /// wider search finds at the far end.
  [[nodiscard]] std::vector<Solution> along(std::size_t index, const std::vector<double>& values) {
    std::vector<Solution> found;
    for (const double value : values) {
      problem_.bounds.low[index] = std::min(problem_.bounds.low[index], value);
      problem_.bounds.high[index] = std::max(problem_.bounds.high[index], value);
      found.push_back(moved_to(problem_, found.empty() ? best_ : found.back(), index, value));
    }
    for (std::size_t i = 0; !found.empty() && i < std::min(kStarts, more_.size()); ++i) {
      Solution start = more_[i];
      start.shared[index] = values.back();
      take_better(solve(problem_, start, kSteps, static_cast<int>(index)), found.back());
    }
    for (std::size_t i = found.size(); i-- > 1;) {
      take_better(moved_to(problem_, found[i], index, values[i - 1]), found[i - 1]);
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
      point.within_95 = specimens_leave(best_costs_, part_costs(problem_, solution));
    } else {
      const double t =
          student(effective_ - static_cast<double>(shared_count(problem_.terms) + kOwnParameters));
      point.deviance = 2.0 * (posterior_of(best_) - posterior_of(solution));
      point.within_95 = point.deviance <= t * t;
    }
    return point;
  }

 private:
  static constexpr std::size_t kStarts = 4;
  static constexpr int kSteps = 60;

  static void take_better(Solution found, Solution& kept) {
    if (found.cost < kept.cost) kept = std::move(found);
  }

  [[nodiscard]] double posterior_of(const Solution& solution) const {
    Point point = solution.shared;
    point.insert(point.end(), solution.own.front().begin(), solution.own.front().end());
    return log_posterior_of(problem_, point, effective_);
  }

  bool pooled_;
  std::vector<Specimen> used_;
  Problem problem_;
  Solution best_;
  std::vector<double> best_costs_;
  std::vector<Solution> more_;  // other places to begin at
  double effective_ = 0.0;
};

Json point_json(const SweepPoint& point) {
  Json json = Json::array({point.value, point.nrmse, point.within_95 ? 1.0 : 0.0});
  json.push_back(std::isfinite(point.deviance) ? Json(point.deviance) : Json(nullptr));
  for (const double value : point.others) json.push_back(value);
  return json;
}

SweepPoint point_of_json(const Json& json) {
  constexpr std::size_t kOthers = 4;  // from there on
  SweepPoint point;
  point.value = json.at(0).get<double>();
  point.nrmse = json.at(1).get<double>();
  point.within_95 = json.at(2).get<double>() > 0.5;
  point.deviance = json.at(3).is_null() ? std::numeric_limits<double>::quiet_NaN() : json.at(3).get<double>();
  for (std::size_t i = kOthers; i < json.size(); ++i) point.others.push_back(json.at(i).get<double>());
  return point;
}

}  // namespace

std::vector<double> sweep_values(const SweepRequest& request, const Estimate& estimate,
                                 const Bounds& bounds) {
  constexpr double kBeside = 1.01;  // factor, at least
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
  std::vector<double> values;
  for (const double value : sweep_values(piece.request, estimate, target.bounds())) {
    if ((value >= best) == piece.upwards) values.push_back(value);
  }
  if (!piece.upwards) std::reverse(values.begin(), values.end());
  Json points = Json::array();
  bool better = false;
  for (const Solution& solution : target.along(index, values)) {
    better = better || solution.cost < kClearlyBetter * target.best().cost;
    points.push_back(point_json(target.point_of(solution, index)));
  }
  const Json json = {{"key", key},
                     {"best_nrmse", target.nrmse_of(target.best())},
                     {"found_better", better},
                     {"points_swept", std::move(points)}};
  return json.dump();
}

void add_sweep_line(const std::string& line, Sweep& sweep) {
  try {
    const Json json = Json::parse(line);
    sweep.best_nrmse = json.at("best_nrmse").get<double>();
    sweep.found_better = sweep.found_better || json.at("found_better").get<bool>();
    for (const Json& point : json.at("points_swept")) sweep.points.push_back(point_of_json(point));
  } catch (const Json::exception& error) {
    throw InputError(std::string("sweep's line: ") + error.what());
  }
}

}  // namespace palpate::fit
