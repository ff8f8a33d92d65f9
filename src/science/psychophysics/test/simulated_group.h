#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "science/psychophysics/group_effect.h"
#include "science/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// A simulated group that compares two stimuli, with interleaved conditions and QUEST+ for each of them.
struct SimulatedGroup {
  int people = 24;
  int trials = 60;             // for each condition
  double ratio = 1.0;          // of s with noise to s without
  double heterogeneity = 0.1;  // standard deviation of ln(s with/s off) between people
};

/// ln s of a person with a just noticeable difference between 8 and 22 %, uniform in its logarithm.
inline double random_ln_spread(Random& random) {
  const double difference = 0.08 * std::pow(0.22 / 0.08, random.uniform());
  return std::log(std::log1p(difference) / 0.67448975);
}

/// The answers of a person at each level. `quest` is reset. @param spread s of each of the two conditions
inline PairedCounts simulate_person(QuestPlus& quest, const double (&spread)[2], double bias, double lapse,
                                    int trials, Random& random) {
  PairedCounts counts;
  for (int condition = 0; condition < 2; ++condition) {
    quest.reset();
    std::vector<Count>& of = condition == 0 ? counts.off : counts.with;
    of.resize(quest.grid().levels.size());
    for (int trial = 0; trial < trials; ++trial) {
      const std::size_t level = quest.next();
      const double second =
          quest.grid().function(quest.grid().levels[level], {bias, spread[condition], lapse});
      const bool answer = random.uniform() < second;
      quest.update(level, answer);
      ++of[level].trials;
      of[level].counted += answer ? 1 : 0;
    }
  }
  return counts;
}

/// All people of a group: interval biases of 0.05 (sd), lapse rates of 0 to 4 %.
inline std::vector<PairedCounts> simulate_group(QuestPlus& quest, const SimulatedGroup& group,
                                                std::uint32_t number) {
  Random random(17, number, static_cast<std::uint32_t>(group.people));
  std::vector<PairedCounts> people;
  for (int person = 0; person < group.people; ++person) {
    const double ln_spread = random_ln_spread(random);
    const double change = std::log(group.ratio) + group.heterogeneity * random.normal();
    const double bias = 0.05 * random.normal();
    const double lapse = 0.04 * random.uniform();
    people.push_back(simulate_person(quest, {std::exp(ln_spread), std::exp(ln_spread + change)}, bias, lapse,
                                     group.trials, random));
  }
  return people;
}

}  // namespace palpate::psychophysics
