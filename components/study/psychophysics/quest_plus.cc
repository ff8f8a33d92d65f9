// QUEST+ [Watson 2017]: which stimulus teaches most about a person's psychometric function?
//
// The method holds a probability for each cell of a grid: location x spread x lapse rate.
//
//     prior --> next(): the level with the least expected entropy --> the person answers --+
//                  ^                                                                       |
//                  +------------- posterior <-- update(): Bayes, p(cell) *= P(answer | cell)
//
// next() is the dear step. It needs, for every level, the mean entropy of the posterior over both answers.
// It does not form these posteriors. The expected entropy is today's entropy less the mutual information
// of answer and parameters, and that needs only the probability of the answer in each cell:
//
//     gain(level) = H(sum_c p_c y_c) - sum_c p_c H(y_c),    H(y) = -y ln y - (1 - y) ln(1 - y)
//
// with p_c the probability of cell c and y_c that of the counted answer in it. The first term is the
// uncertainty of the answer as we see it. The second is what would remain if the parameters were known. A
// level is useful where cells disagree about the answer, and useless where all agree, however uncertain
// that answer is.
//
// Three things make this fast:
// - y is linear in the lapse rate for both shapes. A table over levels and pairs (location, spread) holds
//   y without lapses and its slope, instead of one entry for each lapse rate.
// - When the lapse rate is a nuisance [Prins 2013], the entropy of location and spread alone counts.
//   Because y is linear, a pair answers like one cell at its mean lapse rate. So groups() sums the lapse
//   rates out. Without this, the method would spend trials on easy stimuli, to learn about lapses.
// - H comes from a table of cubic pieces.
//
// Ties within 1e-9 nats go to the lowest level, and own logarithms have the same bits on any x86-64. So a
// log of stimuli and answers replays exactly. A stimulus is not shown more than most_repeats times in
// succession: a person would learn the answer.
//
// An answer that is impossible in every cell throws and leaves the posterior as it is. A grid with a lapse
// rate above 0 avoids this. estimate() gives mean, deviation and interval of any function of the
// parameters; edge_probability() and lapses_often() warn when the grid or the person does not fit.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/base/portable_math.h"
#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

// x ln x, 0 at 0.
double x_log_x(double x) noexcept { return x > 0.0 ? x * portable::log(x) : 0.0; }

// Entropy [nats] of an answer with probability p, -p ln p - (1 - p) ln(1 - p). Interpolation with 4096 cubic
// pieces is five times as fast as logarithms; its error is below 1e-11.
class BinaryEntropy {
 public:
  static const BinaryEntropy& table() {
    static const BinaryEntropy entropy;
    return entropy;
  }

  static double exact(double p) noexcept { return -x_log_x(p) - x_log_x(1.0 - p); }

  double operator()(double p) const noexcept {
    constexpr double kEdge = 1.0 / 64;  // the derivatives grow without limit towards 0 and 1
    if (!(p > kEdge && p < 1.0 - kEdge)) return exact(p);
    const auto piece = static_cast<std::size_t>(p * kPieces);
    const double u = p * kPieces - static_cast<double>(piece);
    const double v = 1.0 - u;
    const Node& a = nodes_[piece];
    const Node& b = nodes_[piece + 1];
    return v * v * ((1.0 + 2.0 * u) * a.value + u * a.slope) +
           u * u * ((1.0 + 2.0 * v) * b.value - v * b.slope);
  }

 private:
  static constexpr int kPieces = 4096;
  struct Node {
    double value = 0.0;
    double slope = 0.0;  // per piece
  };

  BinaryEntropy() {
    for (int i = 1; i < kPieces; ++i) {
      const double p = static_cast<double>(i) / kPieces;
      nodes_[static_cast<std::size_t>(i)] = {exact(p), portable::log((1.0 - p) / p) / kPieces};
    }
  }

  std::array<Node, kPieces + 1> nodes_;
};

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

void normalize(std::vector<double>& probabilities) {
  double sum = 0.0;
  for (const double one : probabilities) sum += one;
  for (double& one : probabilities) one /= sum;
}

/// A value and its probability.
struct Weighted {
  double value = 0.0;
  double weight = 0.0;
};

// Values in ascending order, weights with the sum 1.
double quantile_of(const std::vector<Weighted>& sorted, double probability) {
  double below = 0.0;
  double last_middle = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double middle = below + 0.5 * sorted[i].weight;
    if (middle >= probability) {
      if (i == 0) return sorted[0].value;
      const double before = sorted[i - 1].value;
      return before + (sorted[i].value - before) * (probability - last_middle) / (middle - last_middle);
    }
    below += sorted[i].weight;
    last_middle = middle;
  }
  return sorted.back().value;
}

/// Mean, standard deviation and central 95 % interval of a discrete distribution. Quantiles are interpolated
/// linearly between the values, each at the middle of its step of the distribution function.
/// @param values at least one; weights of any sum > 0
Estimate estimate_of(std::vector<Weighted> values) {
  std::stable_sort(values.begin(), values.end(),
                   [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  std::vector<Weighted> merged;  // equal values as one
  double sum = 0.0;
  for (const Weighted& one : values) {
    sum += one.weight;
    if (!merged.empty() && merged.back().value == one.value) {
      merged.back().weight += one.weight;
    } else {
      merged.push_back(one);
    }
  }
  Estimate found;
  for (Weighted& one : merged) {
    one.weight /= sum;
    found.mean += one.weight * one.value;
  }
  double variance = 0.0;
  for (const Weighted& one : merged) {
    variance += one.weight * (one.value - found.mean) * (one.value - found.mean);
  }
  found.sd = std::sqrt(variance);
  found.low = quantile_of(merged, 0.025);
  found.high = quantile_of(merged, 0.975);
  return found;
}

}  // namespace

QuestPlus::QuestPlus(QuestPlusGrid grid) : grid_(std::move(grid)) {
  check_grid(grid_);
  for (std::size_t i = 0; i < grid_.location.values.size(); ++i) {
    for (std::size_t j = 0; j < grid_.spread.values.size(); ++j) {
      for (std::size_t k = 0; k < grid_.lapse.values.size(); ++k) {
        prior_.push_back(grid_.location.weight(i) * grid_.spread.weight(j) * grid_.lapse.weight(k));
      }
    }
  }
  normalize(prior_);
  for (const double level : grid_.levels) {
    for (const double location : grid_.location.values) {
      for (const double spread : grid_.spread.values) {
        const double without = grid_.function(level, {location, spread, 0.0});
        without_lapse_.push_back(without);
        by_lapse_.push_back(grid_.function(level, {location, spread, 1.0}) - without);
      }
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

double QuestPlus::counted(std::size_t level, std::size_t pair, double lapse) const noexcept {
  const std::size_t pairs = grid_.location.values.size() * grid_.spread.values.size();
  return without_lapse_[level * pairs + pair] + lapse * by_lapse_[level * pairs + pair];
}

std::vector<QuestPlus::Group> QuestPlus::groups() const {
  constexpr double kNegligible = 1e-14;  // groups below it change an entropy by less than 1e-9 nats
  const std::vector<double>& lapses = grid_.lapse.values;
  std::vector<Group> groups;
  for (std::size_t pair = 0; pair < posterior_.size() / lapses.size(); ++pair) {
    Group all{pair};
    for (std::size_t k = 0; k < lapses.size(); ++k) {
      const double probability = posterior_[pair * lapses.size() + k];
      if (!grid_.lapse_is_nuisance && probability > kNegligible) {
        groups.push_back({pair, probability, lapses[k]});
      }
      all.probability += probability;
      all.lapse += probability * lapses[k];
    }
    all.lapse /= std::max(all.probability, kNegligible);
    if (grid_.lapse_is_nuisance && all.probability > kNegligible) groups.push_back(all);
  }
  return groups;
}

// Mutual information of the response and the parameters: H(response) - H(response | parameters).
double QuestPlus::expected_gain(std::size_t level, const std::vector<Group>& groups) const noexcept {
  const BinaryEntropy& entropy = BinaryEntropy::table();
  double all = 0.0;
  double left = 0.0;
  for (const Group& group : groups) {
    const double yes = counted(level, group.pair, group.lapse);
    all += group.probability * yes;
    left += group.probability * entropy(yes);
  }
  return BinaryEntropy::exact(all) - left;
}

std::vector<double> QuestPlus::expected_entropies() const {
  const std::vector<Group> now = groups();
  double entropy = 0.0;
  for (const Group& group : now) entropy -= x_log_x(group.probability);
  std::vector<double> entropies;
  for (std::size_t level = 0; level < grid_.levels.size(); ++level) {
    entropies.push_back(entropy - expected_gain(level, now));
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
    const double yes = this->counted(level, i / grid_.lapse.values.size(), parameters_at(i).lapse);
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

double QuestPlus::edge_probability() const {
  const std::size_t size = posterior_.size() / grid_.location.values.size();
  double first = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    first += posterior_[i];
    last += posterior_[posterior_.size() - 1 - i];
  }
  return std::max(first, last);
}

bool QuestPlus::lapses_often() const {
  constexpr double kOften = 0.05;
  double sum = 0.0;
  for (std::size_t i = 0; i < posterior_.size(); ++i) {
    if (parameters_at(i).lapse >= kOften) sum += posterior_[i];
  }
  return sum > 0.4;  // 0.35 before the first trial
}

}  // namespace palpate::psychophysics
