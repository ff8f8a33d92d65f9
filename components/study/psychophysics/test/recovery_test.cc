// Simulated people are estimated. Bounds hold for another seed with more than 99 % probability.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"

#include "study/psychophysics/psychophysics.h"
#include "study/psychophysics/simulated_group.h"
#include "study/psychophysics/test/study_table.h"

namespace palpate::psychophysics {
namespace {

// Errors of an estimate over people.
struct Errors {
  int people = 0;
  double sum = 0.0;
  double squares = 0.0;
  int covered = 0;
  int warned = 0;

  void add(const Estimate& found, double truth, bool warns) {
    ++people;
    sum += found.mean - truth;
    squares += (found.mean - truth) * (found.mean - truth);
    covered += found.low <= truth && truth <= found.high ? 1 : 0;
    warned += warns ? 1 : 0;
  }
  [[nodiscard]] double bias() const { return sum / people; }
  [[nodiscard]] double rmse() const { return std::sqrt(squares / people); }
  [[nodiscard]] double coverage() const { return static_cast<double>(covered) / people; }
  [[nodiscard]] double warning_rate() const { return static_cast<double>(warned) / people; }
};

using ErrorsByTrials = std::map<int, Errors>;

void print(const std::string& what, const ErrorsByTrials& table) {
  for (const auto& [trials, errors] : table) {
    const std::string of = what + ", " + std::to_string(trials) + " trials: ";
    print_figure(of + "bias", errors.bias());
    print_figure(of + "rmse", errors.rmse());
    print_figure(of + "coverage", errors.coverage());
    print_figure(of + "lapse warnings", errors.warning_rate());
  }
}

// Estimates `people` after each of these numbers of trials. @param catch_every every so many trials show the
// largest level; 0: never
ErrorsByTrials estimate_people(const QuestPlusGrid& grid, int people, std::uint32_t study,
                               const std::vector<int>& after, int catch_every,
                               const std::function<Parameters(Random&)>& person,
                               double (*quantity)(const Parameters&) noexcept) {
  QuestPlus quest(grid);
  ErrorsByTrials table;
  for (int number = 0; number < people; ++number) {
    Random random(23, study, static_cast<std::uint32_t>(number));
    const Parameters truth = person(random);
    quest.reset();
    for (int trial = 1; trial <= after.back(); ++trial) {
      const bool catches = catch_every > 0 && trial % catch_every == 0;
      const std::size_t level = catches ? grid.levels.size() - 1 : quest.next();
      quest.update(level, random.uniform() < grid.function(grid.levels[level], truth));
      if (std::find(after.begin(), after.end(), trial) == after.end()) continue;
      table[trial].add(quest.estimate(quantity), quantity({truth.location, truth.spread, 0.0}),
                       quest.lapses_often());
    }
  }
  return table;
}

// Thresholds within 1 to 100 (sd 0.45 in log10), slopes from 1.3 to 4.5.
Parameters random_threshold(Random& random, double least_lapse, double most_lapse) {
  Parameters at;
  do {
    at.location = 1.0 + 0.45 * random.normal();
  } while (at.location < 0.0 || at.location > 2.0);
  at.spread = 1.3 + 3.2 * random.uniform();
  at.lapse = least_lapse + (most_lapse - least_lapse) * random.uniform();
  return at;
}

// A value of an axis drawn from its prior.
double draw(const GridAxis& axis, Random& random) {
  double sum = 0.0;
  for (std::size_t i = 0; i < axis.values.size(); ++i) sum += axis.weights.empty() ? 1.0 : axis.weights[i];
  double left = sum * random.uniform();
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    left -= axis.weights.empty() ? 1.0 : axis.weights[i];
    if (left < 0.0) return axis.values[i];
  }
  return axis.values.back();
}

TEST(Recovery, ThresholdsOfAttentivePeople) {
  const ErrorsByTrials table = estimate_people(
      detection_grid(1.0, 100.0, 20), simulated(100, 1000), 1, {40, 60, 80}, 10,
      [](Random& random) { return random_threshold(random, 0.0, 0.06); }, threshold_of);
  print("thresholds", table);
  EXPECT_LE(std::abs(table.at(40).bias()), full_table() ? 0.05 : 0.06);
  EXPECT_LE(table.at(40).rmse(), full_table() ? 0.115 : 0.14);
  EXPECT_LE(table.at(60).rmse(), full_table() ? 0.095 : 0.12);
  EXPECT_LE(table.at(80).rmse(), full_table() ? 0.08 : 0.10);
}

TEST(Recovery, ThresholdsOfPeopleWithLapses) {
  for (const double lapse : {0.05, 0.10}) {
    const ErrorsByTrials table = estimate_people(
        detection_grid(1.0, 100.0, 20), simulated(60, 1000), lapse < 0.08 ? 2 : 3, {60, 80}, 10,
        [&](Random& random) { return random_threshold(random, lapse, lapse); }, threshold_of);
    print("lapses " + std::to_string(lapse), table);
    if (lapse < 0.08) {
      EXPECT_LE(std::abs(table.at(60).bias()), 0.05);
      EXPECT_LE(table.at(60).rmse(), full_table() ? 0.10 : 0.13);
    } else {
      EXPECT_LE(std::abs(table.at(80).bias()), 0.08);
      EXPECT_GE(table.at(80).coverage(), full_table() ? 0.92 : 0.85);
      EXPECT_GE(table.at(80).warning_rate(), full_table() ? 0.60 : 0.45);
    }
  }
}

TEST(Recovery, IntervalsOfThresholdsFromThePriorCover) {
  const QuestPlusGrid grid = detection_grid(1.0, 100.0, 20);
  const ErrorsByTrials table = estimate_people(
      grid, simulated(60, 1000), 4, {40, 60, 80}, 10,
      [&](Random& random) {
        return Parameters{draw(grid.location, random), draw(grid.spread, random), draw(grid.lapse, random)};
      },
      threshold_of);
  print("thresholds from the prior", table);
  for (const auto& [trials, errors] : table) {
    EXPECT_GE(errors.coverage(), full_table() ? 0.926 : 0.85);
    EXPECT_LE(errors.coverage(), full_table() ? 0.971 : 1.0);
  }
}

TEST(Recovery, IntervalsOfDifferencesFromThePriorCover) {
  const QuestPlusGrid grid = difference_grid();
  const ErrorsByTrials table = estimate_people(
      grid, simulated(100, 1000), 5, {40, 60, 80}, 0,
      [&](Random& random) {
        return Parameters{draw(grid.location, random), draw(grid.spread, random), draw(grid.lapse, random)};
      },
      log10_difference_of);
  print("differences from the prior", table);
  for (const auto& [trials, errors] : table) {
    EXPECT_GE(errors.coverage(), full_table() ? 0.926 : 0.87);
    EXPECT_LE(errors.coverage(), full_table() ? 0.971 : 1.0);
  }
}

TEST(Recovery, JustNoticeableDifferences) {
  const ErrorsByTrials table = estimate_people(
      difference_grid(), simulated(100, 1000), 6, {60, 120}, 0,
      [](Random& random) {
        const double spread = std::exp(random_ln_spread(random));
        return Parameters{0.05 * random.normal(), spread, 0.04 * random.uniform()};
      },
      log10_difference_of);
  print("differences", table);
  EXPECT_LE(std::abs(table.at(60).bias()), full_table() ? 0.03 : 0.05);
  EXPECT_LE(table.at(60).rmse(), full_table() ? 0.11 : 0.14);
  EXPECT_LE(table.at(120).rmse(), full_table() ? 0.085 : 0.105);
}

}  // namespace
}  // namespace palpate::psychophysics
