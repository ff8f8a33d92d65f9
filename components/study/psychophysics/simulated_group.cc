#include "study/psychophysics/simulated_group.h"

#include <cmath>
#include <cstddef>

namespace palpate::psychophysics {
namespace {

// Index of the next level: a catch trial or QUEST+'s choice.
std::size_t next_level(const QuestPlus& quest, double catch_share, Random& random) {
  if (catch_share > 0.0 && random.uniform() < catch_share) {
    return random.uniform() < 0.5 ? 0 : quest.grid().levels.size() - 1;
  }
  return quest.next();
}

// The answers of a person at each level. @param spread s of each of the two conditions
PairedCounts simulate_person(QuestPlus& quest, const double (&spread)[2], double bias, double lapse,
                             const SimulatedGroup& group, Random& random) {
  PairedCounts counts;
  for (int condition = 0; condition < 2; ++condition) {
    quest.reset();
    std::vector<Count>& of = condition == 0 ? counts.off : counts.with;
    of.resize(quest.grid().levels.size());
    for (int trial = 0; trial < group.trials; ++trial) {
      const std::size_t level = next_level(quest, group.catch_share, random);
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

}  // namespace

double random_ln_spread(Random& random) {
  const double difference = 0.08 * std::pow(0.22 / 0.08, random.uniform());
  return std::log(std::log1p(difference) / 0.67448975);
}

std::vector<PairedCounts> simulate_group(QuestPlus& quest, const SimulatedGroup& group,
                                         std::uint32_t number) {
  Random random(group.seed, number, static_cast<std::uint32_t>(group.people));
  std::vector<PairedCounts> people;
  for (int person = 0; person < group.people; ++person) {
    const double ln_spread = random_ln_spread(random);
    const double change = std::log(group.ratio) + group.heterogeneity * random.normal();
    const double bias = 0.05 * random.normal();
    const double lapse = 0.04 * random.uniform();
    people.push_back(simulate_person(quest, {std::exp(ln_spread), std::exp(ln_spread + change)}, bias, lapse,
                                     group, random));
  }
  return people;
}

}  // namespace palpate::psychophysics
