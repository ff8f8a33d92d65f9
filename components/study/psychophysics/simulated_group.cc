#include "study/psychophysics/simulated_group.h"

#include <cmath>
#include <cstddef>

namespace palpate::psychophysics {
namespace {

// Index of the next level: a catch trial or QUEST+'s choice.
std::size_t next_level(const QuestPlus& quest, double catch_share, Random& random) {
  if (catch_share > 0.0 && random.uniform() < catch_share) {
    const bool comparison = quest.grid().function.shape == PsychometricFunction::Shape::kNormal;
    return comparison && random.uniform() < 0.5 ? 0 : quest.grid().levels.size() - 1;
  }
  return quest.next();
}

// A person's functions without and with noise.
struct TwoFunctions {
  Parameters off, with;
};

TwoFunctions draw_comparison(const SimulatedGroup& group, Random& random) {
  const double ln_spread = random_ln_spread(random);
  const double change = std::log(group.ratio) + group.heterogeneity * random.normal();
  const double bias = 0.05 * random.normal();
  const double lapse = 0.04 * random.uniform();
  return {{bias, std::exp(ln_spread), lapse}, {bias, std::exp(ln_spread + change), lapse}};
}

TwoFunctions draw_detection(const SimulatedGroup& group, Random& random) {
  constexpr double kSlope = 2.5;
  constexpr double kSd = 0.12;  // decades
  const double threshold = group.mean_threshold + kSd * random.normal();
  const double change = std::log10(group.ratio) + std::log10(std::exp(group.heterogeneity)) * random.normal();
  const double lapse = 0.04 * random.uniform();
  const double location = threshold - threshold_of({0.0, kSlope, 0.0});
  return {{location, kSlope, lapse}, {location + change, kSlope, lapse}};
}

// The answers of a person at each level.
PairedCounts simulate_person(QuestPlus& quest, const TwoFunctions& person, const SimulatedGroup& group,
                             Random& random) {
  PairedCounts counts;
  for (int condition = 0; condition < 2; ++condition) {
    quest.reset();
    std::vector<Count>& of = condition == 0 ? counts.off : counts.with;
    of.resize(quest.grid().levels.size());
    for (int trial = 0; trial < group.trials; ++trial) {
      const std::size_t level = next_level(quest, group.catch_share, random);
      const double probability =
          quest.grid().function(quest.grid().levels[level], condition == 0 ? person.off : person.with);
      const bool answer = random.uniform() < probability;
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
  const bool comparison = quest.grid().function.shape == PsychometricFunction::Shape::kNormal;
  std::vector<PairedCounts> people;
  for (int person = 0; person < group.people; ++person) {
    const TwoFunctions drawn = comparison ? draw_comparison(group, random) : draw_detection(group, random);
    people.push_back(simulate_person(quest, drawn, group, random));
  }
  return people;
}

}  // namespace palpate::psychophysics
