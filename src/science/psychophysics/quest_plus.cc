#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/psychophysics.h"
#include "science/psychophysics/weighted.h"

namespace palpate::psychophysics {
namespace {

// x ln x, 0 at 0.
double x_log_x(double x) noexcept { return x > 0.0 ? x * portable::log(x) : 0.0; }

void check_axis(const std::string& name, const GridAxis& axis, double low, double high) {
  if (axis.values.empty()) throw ParameterError(name, 0.0, "at least one value");
  for (const double value : axis.values) {
    if (!(value >= low && value <= high)) throw ParameterError(name, value, "finite and in its range");
  }
  const double count = static_cast<double>(axis.weights.size());
  if (count != 0.0 && axis.weights.size() != axis.values.size()) {
    throw ParameterError(name + " weights", count, "one for each value, or no weights");
  }
  double sum = count == 0.0 ? 1.0 : 0.0;
  for (const double weight : axis.weights) {
    if (!(weight >= 0.0 && std::isfinite(weight))) throw ParameterError(name + " weights", weight, ">= 0");
    sum += weight;
  }
  if (!(sum > 0.0)) throw ParameterError(name + " weights", sum, "a sum > 0");
}

void check_grid(const QuestPlusGrid& grid) {
  constexpr double kLargest = 1e9;
  const double guess = grid.function.guess;
  if (!(guess >= 0.0 && guess < 1.0)) throw ParameterError("guess", guess, ">= 0 and < 1");
  const double unit = grid.function.decades_per_unit;
  if (!(unit > 0.0 && unit < kLargest)) throw ParameterError("decades_per_unit", unit, "> 0");
  if (grid.levels.empty()) throw ParameterError("levels", 0.0, "at least one value");
  for (std::size_t i = 0; i < grid.levels.size(); ++i) {
    const bool ascends = i == 0 || grid.levels[i] > grid.levels[i - 1];
    if (!std::isfinite(grid.levels[i]) || !ascends) {
      throw ParameterError("levels", grid.levels[i], "finite and in ascending order");
    }
  }
  check_axis("location", grid.location, -kLargest, kLargest);
  check_axis("spread", grid.spread, 1.0 / kLargest, kLargest);
  const bool weibull = grid.function.shape == PsychometricFunction::Shape::kWeibull;
  check_axis("lapse", grid.lapse, 0.0, weibull ? 1.0 - guess : 1.0);
  if (grid.most_repeats < 0) throw ParameterError("most_repeats", grid.most_repeats, ">= 0");
}

double weight_of(const GridAxis& axis, std::size_t i) { return axis.weights.empty() ? 1.0 : axis.weights[i]; }

void normalize(std::vector<double>& probabilities) {
  double sum = 0.0;
  for (const double one : probabilities) sum += one;
  for (double& one : probabilities) one /= sum;
}

}  // namespace

QuestPlus::QuestPlus(QuestPlusGrid grid) : grid_(std::move(grid)) {
  check_grid(grid_);
  for (std::size_t i = 0; i < grid_.location.values.size(); ++i) {
    for (std::size_t j = 0; j < grid_.spread.values.size(); ++j) {
      for (std::size_t k = 0; k < grid_.lapse.values.size(); ++k) {
        prior_.push_back(weight_of(grid_.location, i) * weight_of(grid_.spread, j) *
                         weight_of(grid_.lapse, k));
      }
    }
  }
  normalize(prior_);
  counted_.reserve(grid_.levels.size() * prior_.size());
  for (const double level : grid_.levels) {
    for (std::size_t i = 0; i < prior_.size(); ++i) {
      counted_.push_back(grid_.function(level, parameters_at(i)));
    }
  }
  reset();
}

void QuestPlus::reset() {
  posterior_ = prior_;
  repeats_ = 0;
}

Parameters QuestPlus::parameters_at(std::size_t cell) const {
  const std::size_t lapses = grid_.lapse.values.size();
  const std::size_t spreads = grid_.spread.values.size();
  return {grid_.location.values[cell / lapses / spreads], grid_.spread.values[cell / lapses % spreads],
          grid_.lapse.values[cell % lapses]};
}

std::vector<double> QuestPlus::group_sums(std::size_t group) const {
  std::vector<double> sums;
  for (std::size_t first = 0; first < posterior_.size(); first += group) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + group; ++i) sum += posterior_[i];
    sums.push_back(sum);
  }
  return sums;
}

double QuestPlus::posterior_entropy(std::size_t group) const {
  double sum = 0.0;
  for (const double one : group_sums(group)) sum -= x_log_x(one);
  return sum;
}

// Mutual information of the response and the parameters: H(response) - H(response | parameters).
double QuestPlus::expected_gain(std::size_t level, const std::vector<double>& sums) const {
  constexpr double kNegligible = 1e-14;  // groups below it change the gain by less than 1e-10 nats
  const std::size_t group = posterior_.size() / sums.size();
  const double* counted = &counted_[level * posterior_.size()];
  double all = 0.0;
  double left = 0.0;  // sum of -H(response | parameters)
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i] < kNegligible) continue;
    double yes = 0.0;
    for (std::size_t j = i * group; j < (i + 1) * group; ++j) yes += posterior_[j] * counted[j];
    all += yes;
    left += x_log_x(yes) + x_log_x(sums[i] - yes) - x_log_x(sums[i]);
  }
  return left - x_log_x(all) - x_log_x(1.0 - all);
}

std::vector<double> QuestPlus::expected_entropies() const {
  const std::size_t group = grid_.lapse_is_nuisance ? grid_.lapse.values.size() : 1;
  const std::vector<double> sums = group_sums(group);
  const double now = posterior_entropy(group);
  std::vector<double> entropies;
  for (std::size_t level = 0; level < grid_.levels.size(); ++level) {
    entropies.push_back(now - expected_gain(level, sums));
  }
  return entropies;
}

std::size_t QuestPlus::next() const {
  constexpr double kTie = 1e-9;  // nats
  const std::vector<double> entropies = expected_entropies();
  const bool repeated = grid_.most_repeats > 0 && repeats_ >= grid_.most_repeats && entropies.size() > 1;
  const auto allowed = [&](std::size_t level) { return !repeated || level != last_level_; };
  double least = 1e300;
  for (std::size_t i = 0; i < entropies.size(); ++i) {
    if (allowed(i)) least = std::min(least, entropies[i]);
  }
  std::size_t best = 0;
  while (!allowed(best) || entropies[best] > least + kTie) ++best;
  return best;
}

void QuestPlus::update(std::size_t level, bool counted) {
  if (level >= grid_.levels.size()) {
    throw ParameterError("level", static_cast<double>(level), "an index of the grid's levels");
  }
  std::vector<double> updated = posterior_;
  double sum = 0.0;
  for (std::size_t i = 0; i < updated.size(); ++i) {
    const double yes = counted_[level * updated.size() + i];
    updated[i] *= counted ? yes : 1.0 - yes;
    sum += updated[i];
  }
  if (!(sum > 0.0)) {
    throw ParameterError("response", counted ? 1.0 : 0.0, "possible: add a lapse rate > 0 to the grid");
  }
  normalize(updated);
  posterior_ = std::move(updated);
  repeats_ = repeats_ > 0 && level == last_level_ ? repeats_ + 1 : 1;
  last_level_ = level;
}

Estimate QuestPlus::estimate(const std::function<double(const Parameters&)>& quantity) const {
  std::vector<Weighted> values;
  for (std::size_t i = 0; i < posterior_.size(); ++i) {
    values.push_back({quantity(parameters_at(i)), posterior_[i]});
  }
  return estimate_of(std::move(values));
}

Parameters QuestPlus::mode() const {
  const auto largest = std::max_element(posterior_.begin(), posterior_.end());
  return parameters_at(static_cast<std::size_t>(largest - posterior_.begin()));
}

double QuestPlus::entropy() const { return posterior_entropy(1); }

double QuestPlus::edge_probability() const {
  const std::vector<double> locations = group_sums(posterior_.size() / grid_.location.values.size());
  return std::max(locations.front(), locations.back());
}

bool QuestPlus::lapses_often() const {
  constexpr double kOften = 0.05;
  double sum = 0.0;
  for (std::size_t i = 0; i < posterior_.size(); ++i) {
    if (parameters_at(i).lapse >= kOften) sum += posterior_[i];
  }
  return sum > 0.5;
}

}  // namespace palpate::psychophysics
