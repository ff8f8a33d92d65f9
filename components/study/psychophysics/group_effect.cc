#include "study/psychophysics/group_effect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/error.h"

#include "study/psychophysics/nelder_mead.h"
#include "study/psychophysics/normal.h"

namespace palpate::psychophysics {
namespace {

constexpr double kStep = 0.0288;   // of the change of ln s; sums of normal densities need sd >= kStep
constexpr std::size_t kHalf = 52;  // largest change in steps: a factor of 4.5
constexpr std::size_t kChanges = 2 * kHalf + 1;
constexpr std::size_t kBaseSteps = 4;  // steps of the change per step of ln s without noise
constexpr double kLeastEffectSd = 0.03;
constexpr double kLeastSpreadSd = 0.08;

// Normal weights with the sum 1 of `count` values, the first at `first`. Those beyond 6 sd are left out.
struct Weights {
  std::size_t begin = 0;
  std::vector<double> values;
};

Weights normal_weights(double first, double step, std::size_t count, double mean, double sd) {
  constexpr double kFar = 6.0;
  const double last = static_cast<double>(count) - 1.0;
  const double from = std::clamp(std::floor((mean - kFar * sd - first) / step), 0.0, last);
  const double to = std::clamp(std::ceil((mean + kFar * sd - first) / step), from, last);
  Weights weights;
  weights.begin = static_cast<std::size_t>(from);
  double sum = 0.0;
  for (std::size_t i = weights.begin; i <= static_cast<std::size_t>(to); ++i) {
    const double z = (first + static_cast<double>(i) * step - mean) / sd;
    weights.values.push_back(std::exp(-0.5 * z * z));
    sum += weights.values.back();
  }
  for (double& one : weights.values) one /= sum;
  return weights;
}

// A group's tables and the grid of their rows.
struct Tables {
  std::vector<std::vector<double>> people;
  std::size_t bases = 0;
  double first_base = 0.0;
};

// The four numbers of the population. The standard deviations stay above their least values.
struct Population {
  double effect, effect_sd, mean, sd;
};

Population population_of(double effect, const double* rest) {
  return {effect, std::hypot(kLeastEffectSd, rest[2]), rest[0], std::hypot(kLeastSpreadSd, rest[1])};
}

double negative_log_likelihood(const Tables& tables, const Population& at) {
  constexpr double kMaxSd = 3.0;  // of ln s
  const double change_limit = kStep * static_cast<double>(kHalf);
  const double last_base = tables.first_base + kStep * kBaseSteps * static_cast<double>(tables.bases - 1);
  const bool inside = std::abs(at.effect) <= change_limit && at.mean >= tables.first_base - 1.0 &&
                      at.mean <= last_base + 1.0 && at.sd <= kMaxSd && at.effect_sd <= kMaxSd;
  if (!inside) return std::numeric_limits<double>::infinity();
  const Weights bases = normal_weights(tables.first_base, kStep * kBaseSteps, tables.bases, at.mean, at.sd);
  const Weights changes = normal_weights(-change_limit, kStep, kChanges, at.effect, at.effect_sd);
  double sum = 0.0;
  for (const std::vector<double>& table : tables.people) {
    double likelihood = 0.0;
    for (std::size_t i = 0; i < bases.values.size(); ++i) {
      const double* row = &table[(bases.begin + i) * kChanges + changes.begin];
      double of_row = 0.0;
      for (std::size_t j = 0; j < changes.values.size(); ++j) of_row += row[j] * changes.values[j];
      likelihood += bases.values[i] * of_row;
    }
    sum -= std::log(std::max(likelihood, std::numeric_limits<double>::min()));
  }
  return sum;
}

// The profile likelihood: the three other numbers are fitted at each effect, from the last result.
class Profile {
 public:
  Profile(const Tables& tables, const Minimum& best)
      : tables_(tables), rest_(best.at.begin() + 1, best.at.end()), best_(best.value) {}

  // Student's t of the effect: for changes that are known exactly, twice the decrease of the logarithm of the
  // likelihood of N people is N ln(1 + t^2/(N - 1)).
  double distance(double effect) {
    const Minimum found = minimize(
        [&](const std::vector<double>& x) {
          return negative_log_likelihood(tables_, population_of(effect, x.data()));
        },
        rest_, {0.05, 0.05, 0.05}, 1e-5);
    rest_ = found.at;
    const auto people = static_cast<double>(tables_.people.size());
    return std::sqrt((people - 1.0) * std::expm1(2.0 * std::max(0.0, found.value - best_) / people));
  }

 private:
  const Tables& tables_;
  std::vector<double> rest_;
  double best_;
};

// Least and largest ln s without noise. Thresholds of a detection may lie beyond its stimuli.
std::pair<double, double> range_of(const QuestPlusGrid& grid) {
  if (grid.function.shape == PsychometricFunction::Shape::kNormal) {
    return {std::log(grid.spread.values.front()), std::log(grid.spread.values.back())};
  }
  constexpr double kLn10 = 2.30258509299404568402;
  constexpr double kBeyond = 1.2;  // ln of a factor of 3.3
  return {kLn10 * grid.levels.front() - kBeyond, kLn10 * grid.levels.back() + kBeyond};
}

// The effect below (side -1) or above (side 1) the best one whose distance is `limit`, or the end of the
// range.
double find_end(Profile profile, double best, double side, double limit) {
  const double end = side * kStep * static_cast<double>(kHalf);
  double near = best;
  double near_distance = 0.0;
  double far = best;
  double far_distance = 0.0;
  for (double step = 0.1; far_distance < limit; step *= 2.0) {
    near = far;
    near_distance = far_distance;
    if (far == end) return end;
    far = side > 0.0 ? std::min(best + step, end) : std::max(best - step, end);
    far_distance = profile.distance(far);
  }
  for (int i = 0; i < 20 && std::abs(far - near) > 1e-4; ++i) {
    const double share = (limit - near_distance) / (far_distance - near_distance);
    const double tried = near + std::clamp(share, 0.05, 0.95) * (far - near);
    const double distance = profile.distance(tried);
    if (std::abs(distance - limit) < 1e-3 * limit) return tried;
    (distance < limit ? near : far) = tried;
    (distance < limit ? near_distance : far_distance) = distance;
  }
  return 0.5 * (near + far);
}

}  // namespace

GroupModel::GroupModel(const QuestPlusGrid& grid) : function_(grid.function), levels_(grid.levels.size()) {
  const QuestPlus checked(grid);
  const bool comparison = function_.shape == PsychometricFunction::Shape::kNormal;
  if (!comparison && function_.guess != 0.5) throw ParameterError("guess", function_.guess, "0.5");
  if (!comparison && function_.decades_per_unit != 1.0) {
    throw ParameterError("decades_per_unit", function_.decades_per_unit, "1");
  }
  slopes_ = comparison ? GridAxis{{1.0}} : grid.spread;
  const GridAxis biases = comparison ? grid.location : GridAxis{{0.0}};
  for (std::size_t j = 0; j < biases.values.size(); ++j) {
    for (std::size_t k = 0; k < grid.lapse.values.size(); ++k) {
      shared_.push_back({biases.values[j], grid.lapse.values[k]});
      shared_weights_.push_back(biases.weight(j) * grid.lapse.weight(k));
    }
  }
  const auto [first, last] = range_of(grid);
  first_base_ = first;
  bases_ = static_cast<std::size_t>(std::ceil((last - first) / (kStep * kBaseSteps))) + 1;
  spreads_ = (bases_ - 1) * kBaseSteps + kChanges;
  constexpr double kLeastProbability = 1e-12;
  for (std::size_t i = 0; i < spreads_; ++i) {
    const double ln_s = first_base_ + kStep * (static_cast<double>(i) - static_cast<double>(kHalf));
    for (const Shared& shared : shared_) {
      for (const double slope : slopes_.values) {
        const Parameters at = parameters_at(ln_s, shared, slope);
        for (const double level : grid.levels) {
          const double counted = function_(level, at);
          log_counted_.push_back(std::log(std::max(counted, kLeastProbability)));
          log_other_.push_back(std::log(std::max(1.0 - counted, kLeastProbability)));
        }
      }
    }
  }
}

Parameters GroupModel::parameters_at(double ln_s, const Shared& shared, double slope) const {
  if (function_.shape == PsychometricFunction::Shape::kNormal) {
    return {shared.bias, std::exp(ln_s), shared.lapse};
  }
  constexpr double kLn10 = 2.30258509299404568402;
  const double of_zero = threshold_of({0.0, slope, shared.lapse});
  return {ln_s / kLn10 - of_zero, slope, shared.lapse};
}

std::vector<double> GroupModel::likelihood_of(const std::vector<Count>& counts) const {
  if (counts.size() != levels_) {
    throw ParameterError("counts", static_cast<double>(counts.size()), "one for each level");
  }
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < levels_; ++i) {
    if (counts[i].counted < 0 || counts[i].counted > counts[i].trials) {
      throw ParameterError("counted", counts[i].counted, "0 to the number of trials");
    }
    if (counts[i].trials > 0) used.push_back(i);
  }
  const std::size_t slopes = slopes_.values.size();
  std::vector<double> logarithms;
  for (std::size_t cell = 0; cell < spreads_ * shared_.size() * slopes; ++cell) {
    double sum = 0.0;
    for (const std::size_t i : used) {
      sum += counts[i].counted * log_counted_[cell * levels_ + i] +
             (counts[i].trials - counts[i].counted) * log_other_[cell * levels_ + i];
    }
    logarithms.push_back(sum);
  }
  const double largest = *std::max_element(logarithms.begin(), logarithms.end());
  std::vector<double> result(spreads_ * shared_.size());
  for (std::size_t cell = 0; cell < logarithms.size(); ++cell) {
    result[cell / slopes] += slopes_.weight(cell % slopes) * std::exp(logarithms[cell] - largest);
  }
  return result;
}

std::vector<double> GroupModel::table_of(const PairedCounts& person) const {
  const std::vector<double> off = likelihood_of(person.off);
  const std::vector<double> with = likelihood_of(person.with);
  const std::size_t pairs = shared_weights_.size();
  std::vector<double> table;
  std::vector<double> weighted(pairs);
  for (std::size_t base = 0; base < bases_; ++base) {
    for (std::size_t k = 0; k < pairs; ++k) {
      weighted[k] = shared_weights_[k] * off[(base * kBaseSteps + kHalf) * pairs + k];
    }
    for (std::size_t change = 0; change < kChanges; ++change) {
      const double* row = &with[(base * kBaseSteps + change) * pairs];
      double sum = 0.0;
      for (std::size_t k = 0; k < pairs; ++k) sum += weighted[k] * row[k];
      table.push_back(sum);
    }
  }
  return table;
}

double GroupModel::largest_effect() noexcept { return kStep * static_cast<double>(kHalf); }

GroupEffect GroupModel::fit(std::span<const PairedCounts> people) const {
  const auto number = static_cast<double>(people.size());
  if (number < 2.0) throw ParameterError("people", number, ">= 2");
  Tables tables{{}, bases_, first_base_};
  for (const PairedCounts& person : people) tables.people.push_back(table_of(person));
  const auto cost = [&](const std::vector<double>& x) {
    return negative_log_likelihood(tables, population_of(x[0], &x[1]));
  };
  const double middle = first_base_ + 0.5 * kStep * kBaseSteps * static_cast<double>(bases_ - 1);
  const Minimum best = minimize(cost, {0.0, middle, 0.4, 0.15}, {0.15, 0.3, 0.2, 0.15}, 1e-6);
  const Population at = population_of(best.at[0], &best.at[1]);
  const double limit = student_t_quantile(number - 1.0);
  GroupEffect found;
  found.effect = at.effect;
  found.low = find_end(Profile(tables, best), at.effect, -1.0, limit);
  found.high = find_end(Profile(tables, best), at.effect, 1.0, limit);
  found.p_value = student_t_two_sided(Profile(tables, best).distance(0.0), number - 1.0);
  found.effect_sd = at.effect_sd;
  found.mean_ln_spread = at.mean;
  found.ln_spread_sd = at.sd;
  return found;
}

}  // namespace palpate::psychophysics
