#include "study/session/analysis.h"

#include <cmath>

#include "palpate/error.h"

#include "study/session/analysis_parts.h"

namespace palpate::study {
namespace {

// The labels of blind analysis: A, B, C.
std::string label_of(std::size_t index) { return std::string(1, static_cast<char>('A' + index)); }

/// Counts a person once: as consented after any "yes", as refused if there is only "no".
void count_consent(const Participant& person, StudyAnalysis& analysis) {
  bool asked = false;
  bool consented = false;
  for (const EventRecord& event : person.log.events) {
    if (event.event != "consent") continue;
    asked = true;
    consented = consented || event.value("answer") == "yes";
  }
  if (asked) ++(consented ? analysis.consented : analysis.refused);
}

}  // namespace

Readable readable_level(const StudyTask& task, double level) noexcept {
  const LevelScale& scale = describe(task.kind).scale;
  return {scale.factor * scale.value(level), scale.unit};
}

Readable readable_estimate(const StudyTask& task, double log10_estimate) noexcept {
  if (task.comparison()) return {100.0 * std::pow(10.0, log10_estimate), "%"};
  return readable_level(task, log10_estimate);
}

bool is_number(const std::optional<ThresholdFit>& fit) noexcept { return fit && !fit->range_too_small; }

bool target_second(const StudyTask& task, const TrialRecord& trial) noexcept {
  return task.comparison() ? trial.second == (trial.level > 0.0) : trial.second;
}

ArmNames::ArmNames(const Study& study, SealedKey key, bool unblinded)
    : study_(study), key_(key), unblinded_(unblinded) {
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    const std::vector<Arm>& arms = study.tasks[task].arms;
    labels_.push_back(labels_of_arms(key, task, arms.size()));
    TaskResult result;
    for (std::size_t i = 0; i < arms.size(); ++i) {
      result.arms.push_back(arms.size() == 1 || unblinded ? arms[i].name : label_of(i));
      if (unblinded) result.shares.push_back(arms[i].share);
    }
    tasks_.push_back(result);
  }
}

std::size_t ArmNames::arm_of(std::uint32_t participant, std::size_t task, const std::string& code) const {
  const std::size_t arms = study_.tasks[task].arms.size();
  for (std::size_t i = 0; i < arms; ++i) {
    if (code == "c" + std::to_string(i + 1)) return arms_of_codes(key_, participant, task, arms)[i];
  }
  throw InputError(study_.tasks[task].name + ": code = `" + code + "`, must be c1 to c" +
                   std::to_string(arms));
}

std::size_t ArmNames::index_of(std::uint32_t participant, std::size_t task, const std::string& code) const {
  const std::size_t arm = arm_of(participant, task, code);
  return unblinded_ ? arm : labels_[task][arm];
}

bool ArmNames::has_noise(std::uint32_t participant, std::size_t task, const std::string& code) const {
  return study_.tasks[task].arms[arm_of(participant, task, code)].share > 0.0;
}

StudyAnalysis analyse(const Study& study, std::span<const Participant> people, SealedKey key,
                      bool unblinded) {
  const ArmNames names(study, key, unblinded);
  StudyAnalysis analysis;
  analysis.unblinded = unblinded;
  analysis.tasks = names.tasks();
  std::vector<std::optional<psychophysics::QuestPlus>> quests;
  for (const StudyTask& task : study.tasks) {
    quests.emplace_back();
    if (has_function(task)) quests.back().emplace(grid_with_levels(task, people));
  }
  for (const Participant& person : people) {
    count_consent(person, analysis);
    if (person.log.trials.empty() && !person.log.withdrawn()) continue;
    analysis.people.push_back(analyse_person(study, person, names, quests));
    const PersonResult& result = analysis.people.back();
    analysis.withdrawn += result.withdrawn ? 1 : 0;
    analysis.excluded += !result.withdrawn && !result.kept() ? 1 : 0;
  }
  analysis.deleted = deletions_of(people);
  analyse_group(study, quests, analysis);
  analysis.guesses = count_guesses(study, people, names);
  return analysis;
}

Deletions deletions_of(std::span<const Participant> people) {
  Deletions deletions;
  for (const Participant& person : people) {
    if (const auto deletion = person.log.deletion()) deletions.emplace_back(person.log.id, *deletion);
  }
  return deletions;
}

std::vector<Participant> read_people(const StudyFolder& study) {
  std::vector<Participant> people;
  for (std::uint32_t number = 0; number < study.ids.size(); ++number) {
    people.push_back({number, study.read(study.ids[number])});
  }
  return people;
}

}  // namespace palpate::study
