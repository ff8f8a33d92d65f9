#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

#include "study/psychophysics/group_effect.h"
#include "study/psychophysics/normal.h"
#include "study/session/analysis_parts.h"

namespace palpate::study {
namespace {

using psychophysics::GroupModel;
using psychophysics::PairedCounts;
using psychophysics::PairedTest;
using psychophysics::QuestPlus;
using People = std::vector<const PersonResult*>;

constexpr int kLeastOfArm = 10;           // of a person in each of two arms that are compared
constexpr std::size_t kLeastOfCurve = 3;  // arms

// Enough answers of a person in an arm, for any measure of the task.
bool is_enough(const StudyTask& task, const ArmResult& arm) {
  return task.two_intervals() ? arm.trials >= kLeastOfArm : arm.ln_rms && arm.ln_variation;
}

// One person's measure in an arm with enough answers.
double value_of(const ArmResult& arm, const std::string& measure) {
  if (measure == "ln_rms") return arm.ln_rms.value();
  if (measure == "ln_variation") return arm.ln_variation.value();
  return arm.sensitivity.value().d_prime;
}

Effect effect_of(const PairedTest& test, std::size_t people) {
  return {static_cast<int>(people), test.mean, test.low, test.high, test.two_sided, false, 0.0, {}};
}

Effect effect_of(const psychophysics::GroupEffect& found, std::size_t people) {
  const double end = 0.999 * GroupModel::largest_effect();
  const bool open = found.low < -end || found.high > end;
  return {static_cast<int>(people), found.effect, found.low, found.high, found.p_value, open, 0.0, {}};
}

// The mean effect if each of those left out had one end of the range.
void bound(Effect& effect, double low, double high) {
  const auto all = static_cast<double>(effect.people + effect.missing.people);
  const auto mean = [&](double end) {
    return (effect.people * effect.effect + effect.missing.people * end) / all;
  };
  effect.missing.low = mean(low);
  effect.missing.high = mean(high);
}

void finish(Effect& effect, const std::string& alternative) {
  using psychophysics::student_t_quantile;
  constexpr double kPower = 0.8;
  const double freedom = effect.people - 1.0;
  const double alpha = alternative == "two-sided" ? 0.025 : 0.05;
  effect.p_value = p_of_alternative(effect.p_value, effect.effect, alternative);
  effect.smallest_effect = 0.5 * (effect.high - effect.low) *
                           (student_t_quantile(freedom, 1.0 - alpha) + student_t_quantile(freedom, kPower)) /
                           student_t_quantile(freedom);
}

std::vector<psychophysics::Count> counts_of(const ArmResult& arm, const std::vector<double>& levels) {
  std::vector<psychophysics::Count> counts(levels.size());
  for (const Point& point : arm.points) {
    constexpr double kSameLevel = 1e-9;
    const auto level = std::lower_bound(levels.begin(), levels.end(), point.level - kSameLevel);
    psychophysics::Count& count = counts[static_cast<std::size_t>(level - levels.begin())];
    count.trials += point.count.trials;
    count.counted += point.count.counted;
  }
  return counts;
}

// The model and the stimuli of a task with a psychometric function.
struct Functions {
  GroupModel model;
  const std::vector<double>& levels;
};

std::optional<Effect> measure_effect(const StudyTask& task, const People& people, const Contrast& contrast,
                                     const Functions* functions) {
  std::vector<double> differences;
  std::vector<PairedCounts> counts;
  Missing missing;
  for (const PersonResult* person : people) {
    const ArmResult& with = person->tasks[contrast.task].arms[contrast.condition];
    const ArmResult& off = person->tasks[contrast.task].arms[contrast.reference];
    if (!is_enough(task, with) || !is_enough(task, off)) {
      ++missing.people;
      missing.in_condition += is_enough(task, with) ? 0 : 1;
      missing.in_reference += is_enough(task, off) ? 0 : 1;
      continue;
    }
    missing.outside_condition += with.fit && with.fit->range_too_small ? 1 : 0;
    missing.outside_reference += off.fit && off.fit->range_too_small ? 1 : 0;
    if (functions != nullptr) {
      counts.push_back({counts_of(off, functions->levels), counts_of(with, functions->levels)});
    } else {
      differences.push_back(value_of(with, contrast.measure) - value_of(off, contrast.measure));
    }
  }
  if (std::max(differences.size(), counts.size()) < 2) return std::nullopt;
  Effect effect = functions != nullptr ? effect_of(functions->model.fit(counts), counts.size())
                                       : effect_of(psychophysics::paired_t(differences), differences.size());
  effect.missing = missing;
  if (functions != nullptr) {
    bound(effect, -GroupModel::largest_effect(), GroupModel::largest_effect());
  } else {
    const auto [least, largest] = std::minmax_element(differences.begin(), differences.end());
    bound(effect, *least, *largest);
  }
  finish(effect, contrast.alternative);
  return effect;
}

// Index of the arm that the others are compared with.
std::size_t reference_of(const Study& study, std::size_t task) {
  const std::vector<Arm>& arms = study.tasks[task].arms;
  const auto named = [&](const std::string& name) {
    return std::find_if(arms.begin(), arms.end(), [&](const Arm& arm) { return arm.name == name; });
  };
  if (study.primary && study.primary->task == study.tasks[task].name) {
    if (const auto found = named(study.primary->reference); found != arms.end()) {
      return static_cast<std::size_t>(found - arms.begin());
    }
  }
  const auto silent = std::find_if(arms.begin(), arms.end(), [](const Arm& arm) { return arm.share == 0.0; });
  return silent == arms.end() ? 0 : static_cast<std::size_t>(silent - arms.begin());
}

// Pairs of arms that are compared: all of them while blind, else each one with the reference.
std::vector<std::pair<std::size_t, std::size_t>> pairs_of(const Study& study, std::size_t task,
                                                          bool unblinded) {
  const std::size_t arms = study.tasks[task].arms.size();
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (unblinded) {
    const std::size_t reference = reference_of(study, task);
    for (std::size_t i = 0; i < arms; ++i) {
      if (i != reference) pairs.emplace_back(i, reference);
    }
    return pairs;
  }
  for (std::size_t i = 0; i < arms; ++i) {
    for (std::size_t j = i + 1; j < arms; ++j) pairs.emplace_back(j, i);
  }
  return pairs;
}

bool is_primary(const Study& study, const Contrast& contrast) {
  if (!study.primary || study.tasks[contrast.task].name != study.primary->task) return false;
  const std::vector<Arm>& arms = study.tasks[contrast.task].arms;
  return arms[contrast.condition].name == study.primary->condition &&
         arms[contrast.reference].name == study.primary->reference &&
         contrast.measure == study.primary->measure;
}

void adjust_by_holm(std::vector<Contrast>& contrasts) {
  std::vector<double> p_values;
  std::vector<Contrast*> exploratory;
  for (Contrast& contrast : contrasts) {
    if (contrast.primary || !contrast.kept) continue;
    exploratory.push_back(&contrast);
    p_values.push_back(contrast.kept->p_value);
  }
  const std::vector<double> adjusted = psychophysics::holm(p_values);
  for (std::size_t i = 0; i < exploratory.size(); ++i) exploratory[i]->holm = adjusted[i];
}

std::vector<Contrast> contrasts_of(const Study& study, std::size_t task, bool unblinded,
                                   const std::optional<QuestPlus>& quest, const People& kept,
                                   const People& everybody) {
  std::vector<Contrast> contrasts;
  const bool curve = study.tasks[task].signal && study.tasks[task].arms.size() >= kLeastOfCurve;
  if (curve && !unblinded) return contrasts;  // its levels are shown, without pairs
  const auto pairs = pairs_of(study, task, unblinded);
  if (pairs.empty()) return contrasts;
  std::optional<Functions> functions;
  if (quest) functions.emplace(Functions{GroupModel(quest->grid()), quest->grid().levels});
  const Functions* model = functions ? &*functions : nullptr;
  for (const std::string& measure : measures_of(study.tasks[task])) {
    for (const auto& [condition, reference] : pairs) {
      Contrast contrast;
      contrast.task = task;
      contrast.condition = condition;
      contrast.reference = reference;
      contrast.measure = measure;
      contrast.primary = unblinded && is_primary(study, contrast);
      if (contrast.primary) contrast.alternative = study.primary->alternative;
      contrast.kept = measure_effect(study.tasks[task], kept, contrast, model);
      contrast.everybody = everybody.size() == kept.size()
                               ? contrast.kept
                               : measure_effect(study.tasks[task], everybody, contrast, model);
      if (contrast.primary || contrast.everybody) contrasts.push_back(contrast);
    }
  }
  adjust_by_holm(contrasts);
  return contrasts;
}

// Indices of the arms with these shares.
std::vector<std::size_t> arms_with(const StudyTask& task, const std::vector<double>& shares) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < task.arms.size(); ++i) {
    const auto same = [&](double share) { return std::abs(share - task.arms[i].share) < 1e-9; };
    if (std::any_of(shares.begin(), shares.end(), same)) found.push_back(i);
  }
  return found;
}

double mean_at(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double sum = 0.0;
  for (const std::size_t i : indices) sum += values[i];
  return sum / static_cast<double>(indices.size());
}

// The levels of the registered contrast in the order that inverted_u() takes: first, middle ones, last.
void test_inverted_u(const StudyTask& task, const InvertedUAnalysis& registered, Curve& curve) {
  const std::vector<std::size_t> first = arms_with(task, registered.first);
  const std::vector<std::size_t> middle = arms_with(task, registered.middle);
  const std::vector<std::size_t> last = arms_with(task, registered.last);
  if (first.empty() || middle.empty() || last.empty()) {
    throw InputError("inverted_u: a share is not one of the shares of task " + task.name);
  }
  std::vector<std::vector<double>> three;
  for (const std::vector<double>& person : curve.d_primes) {
    three.push_back({mean_at(person, first), mean_at(person, middle), mean_at(person, last)});
  }
  curve.inverted_u = psychophysics::inverted_u(three, std::vector<std::size_t>{1});
  curve.found = curve.inverted_u->rise.greater <= registered.alpha &&
                curve.inverted_u->fall.greater <= registered.alpha;
}

std::optional<Curve> curve_of(const Study& study, std::size_t task, bool unblinded, const People& kept) {
  const StudyTask& of = study.tasks[task];
  if (!of.signal || of.arms.size() < kLeastOfCurve) return std::nullopt;
  Curve curve;
  curve.task = task;
  for (const PersonResult* person : kept) {
    std::vector<double> values;
    for (const ArmResult& arm : person->tasks[task].arms) {
      if (is_enough(of, arm)) values.push_back(value_of(arm, "d_prime"));
    }
    if (values.size() == of.arms.size()) curve.d_primes.push_back(values);
  }
  if (curve.d_primes.size() < 2) return std::nullopt;
  for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
    std::vector<double> values;
    for (const std::vector<double>& person : curve.d_primes) values.push_back(person[arm]);
    curve.levels.push_back(psychophysics::paired_t(values));
  }
  if (unblinded && study.inverted_u && study.inverted_u->task == of.name) {
    test_inverted_u(of, *study.inverted_u, curve);
  }
  return curve;
}

void add_changes(std::size_t task, const People& kept, std::vector<GroupChange>& changes) {
  std::vector<double> trends;
  std::vector<double> drifts;
  std::map<std::string, std::vector<double>> cues;
  for (const PersonResult* person : kept) {
    const PersonTask& of = person->tasks[task];
    if (of.trend) trends.push_back(of.trend->change);
    for (const CueWeight& cue : of.cues) cues[cue.cue].push_back(cue.correlation);
    for (const ArmResult& arm : of.arms) {
      if (!is_number(arm.fit) || !is_number(arm.repeated)) continue;
      drifts.push_back(arm.repeated->estimate.mean - arm.fit->estimate.mean);
    }
  }
  if (trends.size() >= 2) {
    changes.push_back(
        {task, "log odds of a correct answer, first to last trial", psychophysics::paired_t(trends)});
  }
  for (const auto& [cue, correlations] : cues) {
    if (correlations.size() < 2) continue;
    changes.push_back({task, "correlation of the answer with " + cue + " at the same stiffness",
                       psychophysics::paired_t(correlations)});
  }
  if (drifts.size() >= 2) {
    changes.push_back(
        {task, "log10 of the threshold, repetition less first", psychophysics::paired_t(drifts)});
  }
}

// While blind, the arm is not named: beside the log it would reveal a person's code.
void note_left_out(const Study& study, const StudyAnalysis& analysis, PersonResult& person) {
  for (std::size_t task = 0; task < person.tasks.size(); ++task) {
    const StudyTask& of = study.tasks[task];
    if (of.arms.size() < 2) continue;
    std::vector<std::string> few;
    for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
      if (!is_enough(of, person.tasks[task].arms[arm])) few.push_back(analysis.tasks[task].arms[arm]);
    }
    if (few.empty()) continue;
    const std::string where = few.size() == of.arms.size() ? "all conditions"
                              : analysis.unblinded         ? joined(few)
                                                           : "some conditions";
    person.left_out.push_back(of.two_intervals()
                                  ? fmt::format("{}: {}, fewer than {} trials", of.name, where, kLeastOfArm)
                                  : fmt::format("{}: {}, no trials", of.name, where));
  }
}

}  // namespace

double p_of_alternative(double two_sided, double effect, const std::string& alternative) noexcept {
  if (alternative == "two-sided") return two_sided;
  const bool expected = alternative == "less" ? effect < 0.0 : effect > 0.0;
  return expected ? 0.5 * two_sided : 1.0 - 0.5 * two_sided;
}

void analyse_group(const Study& study, const std::vector<std::optional<QuestPlus>>& quests,
                   StudyAnalysis& analysis) {
  People kept;
  People everybody;
  for (PersonResult& person : analysis.people) {
    note_left_out(study, analysis, person);
    if (person.kept()) kept.push_back(&person);
    if (!person.withdrawn) everybody.push_back(&person);
  }
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    for (Contrast& contrast : contrasts_of(study, task, analysis.unblinded, quests[task], kept, everybody)) {
      analysis.contrasts.push_back(std::move(contrast));
    }
    if (std::optional<Curve> curve = curve_of(study, task, analysis.unblinded, kept)) {
      analysis.curves.push_back(std::move(*curve));
    }
    add_changes(task, kept, analysis.changes);
    std::vector<double> gains;
    for (const PersonResult* person : kept) {
      if (const auto& gain = person->tasks[task].own_level_gain) gains.push_back(*gain);
    }
    if (gains.size() < 2) continue;
    analysis.own_level = effect_of(psychophysics::paired_t(gains), gains.size());
    finish(*analysis.own_level, "two-sided");
  }
  std::stable_partition(analysis.contrasts.begin(), analysis.contrasts.end(),
                        [](const Contrast& contrast) { return contrast.primary; });
}

std::vector<Guesses> count_guesses(const Study& study, std::span<const Participant> people,
                                   const ArmNames& names) {
  std::map<std::pair<std::string, bool>, Guesses> guesses;
  for (const Participant& person : people) {
    if (person.log.withdrawn()) continue;
    for (const EventRecord& event : person.log.events) {
      if (event.event != "blinding") continue;
      const std::optional<std::size_t> task = study.find_task(event.value("task"));
      if (!task || study.tasks[*task].stimulus() == Stimulus::kNoise) continue;  // always noise
      const bool noise = names.unblinded() && names.has_noise(person.number, *task, event.value("code"));
      Guesses& of = guesses[{event.value("who"), noise}];
      of.who = event.value("who");
      of.noise = noise;
      of.pooled = !names.unblinded();
      const std::string answer = event.value("answer");
      ++(answer == "yes" ? of.yes : answer == "no" ? of.no : of.unsure);
      of.confidence += palpate::parse_number(event.value("confidence")).value_or(0.0);
    }
  }
  std::vector<Guesses> all;
  for (auto& [key, of] : guesses) {
    of.confidence /= of.yes + of.no + of.unsure;
    all.push_back(std::move(of));
  }
  return all;
}

}  // namespace palpate::study
