#include <map>
#include <utility>

#include "core/base/text.h"

#include "study/session/analysis_parts.h"

namespace palpate::study {
namespace {

struct Sums {
  int yes = 0;
  int no = 0;
  int unsure = 0;
  double confidence = 0.0;
};

}  // namespace

std::vector<Guesses> count_guesses(const Study& study, std::span<const Participant> people,
                                   const ArmNames& names) {
  std::map<std::pair<std::string, bool>, Sums> sums;
  for (const Participant& person : people) {
    if (person.log.withdrawn()) continue;
    for (const EventRecord& event : person.log.events) {
      if (event.event != "blinding") continue;
      const std::optional<std::size_t> task = study.find_task(event.value("task"));
      if (!task || study.tasks[*task].stimulus() == Stimulus::kNoise) continue;  // always noise
      const bool noise = names.unblinded() && names.has_noise(person.number, *task, event.value("code"));
      Sums& of = sums[{event.value("who"), noise}];
      const std::string answer = event.value("answer");
      ++(answer == "yes" ? of.yes : answer == "no" ? of.no : of.unsure);
      of.confidence += palpate::parse_number(event.value("confidence")).value_or(0.0);
    }
  }
  std::vector<Guesses> all;
  for (const auto& [key, of] : sums) {
    Guesses guesses;
    guesses.who = key.first;
    guesses.noise = key.second;
    guesses.pooled = !names.unblinded();
    guesses.yes = of.yes;
    guesses.no = of.no;
    guesses.unsure = of.unsure;
    guesses.confidence = of.confidence / (of.yes + of.no + of.unsure);
    all.push_back(guesses);
  }
  return all;
}

}  // namespace palpate::study
