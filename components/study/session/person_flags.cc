#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"

#include "study/session/analysis_parts.h"
#include "study/session/course.h"

namespace palpate::study {
namespace {

constexpr int kLeastAnswers = 20;  // for a statement about a person's answers

// Answers and cues of the trials that count, of tasks with two intervals.
Trials counted_trials(const Study& study, const Participant& person) {
  Trials trials;
  for (const TrialRecord& trial : person.log.trials) {
    const std::optional<std::size_t> task = study.find_task(trial.task);
    if (!trial.practice && trial.spoiled.empty() && study.tasks[*task].two_intervals()) {
      trials.push_back(&trial);
    }
  }
  return trials;
}

void flag_answers(const Trials& trials, PersonResult& result) {
  constexpr double kNearlyAll = 0.9;
  constexpr double kRepeats = 0.75;  // independent answers repeat in half of the trials
  if (trials.size() < kLeastAnswers) return;
  double first = 0.0;
  double repeats = 0.0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    first += trials[i]->answer == 1 ? 1.0 : 0.0;
    repeats += i > 0 && trials[i]->answer == trials[i - 1]->answer ? 1.0 : 0.0;
  }
  first /= static_cast<double>(trials.size());
  repeats /= static_cast<double>(trials.size() - 1);
  if (first > kNearlyAll || first < 1.0 - kNearlyAll) {
    result.flags.push_back(fmt::format("answers {} in {} of the trials",
                                       first > 0.5 ? "\"first\"" : "\"second\"",
                                       percent(std::max(first, 1.0 - first), 0)));
  } else if (repeats > kRepeats) {
    result.flags.push_back("repeats the last answer in " + percent(repeats, 0) + " of the trials");
  }
}

// Flags a task whose correct answers are no more frequent than by chance.
void flag_chance(const StudyTask& task, const PersonTask& result, std::vector<std::string>& flags) {
  constexpr double kOneSided = 1.645;
  double trials = 0.0;
  double correct = 0.0;
  for (const ArmResult& arm : result.arms) {
    trials += arm.in_first.trials + arm.in_second.trials;
    correct += arm.in_first.counted + arm.in_second.counted;
  }
  if (trials < kLeastAnswers) return;
  if ((correct - 0.5 * trials) / std::sqrt(0.25 * trials) > kOneSided) return;
  flags.push_back(
      fmt::format("{}: {} correct, not better than chance", task.name, percent(correct / trials, 0)));
}

void flag_fits(const Study& study, std::size_t task, const PersonTask& result, const TaskResult& names,
               std::vector<std::string>& flags) {
  const StudyTask& of = study.tasks[task];
  const bool named = !names.shares.empty() && names.arms.size() > 1;  // not while blind
  for (std::size_t i = 0; i < result.arms.size(); ++i) {
    const ArmResult& arm = result.arms[i];
    const std::string where = named ? of.name + ", " + names.arms[i] : of.name;
    const std::string small = where + ": range of stimuli too small";
    const bool is_new = std::find(flags.begin(), flags.end(), small) == flags.end();
    if (arm.fit && arm.fit->range_too_small && is_new) flags.push_back(small);
    if (!is_number(arm.fit) || !is_number(arm.repeated)) continue;
    const double change = arm.repeated->estimate.mean - arm.fit->estimate.mean;
    const double error = std::hypot(arm.repeated->estimate.sd, arm.fit->estimate.sd);
    if (std::abs(change) < 1.96 * error) continue;
    flags.push_back(fmt::format("{}: threshold changed by a factor of {:.2f} to the end of the session",
                                where, std::pow(10.0, change)));
  }
}

void flag_course(const StudyTask& task, const PersonTask& result, std::vector<std::string>& flags) {
  constexpr double kTrend = 2.576;  // 99 %
  if (result.trend && std::abs(result.trend->z) > kTrend) {
    flags.push_back(fmt::format("{}: {} over the task (log odds {:+.1f})", task.name,
                                result.trend->z < 0.0 ? "tires, fewer correct" : "learns, more correct",
                                result.trend->change));
  }
  for (const CueWeight& cue : result.cues) {
    if (cue.low <= 0.0 && cue.high >= 0.0) continue;
    flags.push_back(fmt::format("{}: answers by {} (r = {:.2f} at the same stiffness)", task.name, cue.cue,
                                cue.correlation));
  }
}

// A threshold at the edge of the stimuli, and practice that ended without its criterion.
void flag_preparation(const Study& study, const Participant& person, PersonResult& result) {
  const std::optional<std::size_t> setter = study.threshold_task();
  if (setter) {
    for (const SessionThreshold& one : result.tasks[*setter].thresholds) {
      if (!one.fit.range_too_small) continue;
      const std::string where =
          fmt::format("{}: at the edge of the stimuli in session {}, so its noise is no share of it",
                      study.tasks[*setter].name, one.session);
      (study.exclude_threshold_at_edge ? result.exclusions : result.flags).push_back(where);
    }
  }
  for (const EventRecord& event : person.log.events) {
    if (event.event != "practice" || event.value("met") != "no") continue;
    result.flags.push_back(fmt::format(
        "{}: practice ended with {} of the last {} correct, its criterion not met",
        excerpt(event.value("task")), excerpt(event.value("correct")), excerpt(event.value("of"))));
  }
}

void exclude(const Study& study, PersonResult& result) {
  const psychophysics::Count& easy = result.catch_trials;
  if (easy.trials > 0 && easy.counted < study.exclude_catch_below * easy.trials) {
    result.exclusions.push_back(fmt::format("{} of {} catch trials correct, less than {}", easy.counted,
                                            easy.trials, percent(study.exclude_catch_below, 0)));
  }
  const int all = result.trials + result.spoiled;
  if (all > 0 && result.spoiled > study.exclude_lost_above * all) {
    result.exclusions.push_back(fmt::format("{} of {} trials spoiled, more than {}", result.spoiled, all,
                                            percent(study.exclude_lost_above, 0)));
  }
}

}  // namespace

std::vector<CueWeight> cue_weights(const Trials& trials) {
  using Cue = double IntervalCues::*;
  static constexpr std::pair<const char*, Cue> kCues[] = {{"peak force", &IntervalCues::peak_force},
                                                          {"depth", &IntervalCues::depth},
                                                          {"work", &IntervalCues::work}};
  std::map<std::pair<double, bool>, Trials> strata;  // the same level and order
  for (const TrialRecord* trial : trials) strata[{trial->level, trial->second}].push_back(trial);
  std::vector<CueWeight> weights;
  for (const auto& [name, cue] : kCues) {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double freedom = -1.0;
    double size_x = 0.0;  // distinguishes a constant cue from rounding
    for (const auto& [key, members] : strata) {
      const auto size = static_cast<double>(members.size());
      double sx = 0.0;
      double sy = 0.0;
      for (const TrialRecord* trial : members) {
        // Comparison less standard.
        const double x = (trial->intervals[1].*cue - trial->intervals[0].*cue) * (trial->second ? 1 : -1);
        const double y = trial->counted ? 1.0 : 0.0;
        sx += x, sy += y, size_x += x * x, xx += x * x, xy += x * y, yy += y * y;
      }
      xx -= sx * sx / size, xy -= sx * sy / size, yy -= sy * sy / size;
      freedom += size - 1.0;
    }
    if (freedom < kLeastAnswers || !(xx > 1e-9 * size_x) || !(yy > 1e-9)) continue;
    const double r = std::clamp(xy / std::sqrt(xx * yy), -0.999, 0.999);
    const double half = 2.576 / std::sqrt(freedom - 2.0);  // [Fisher 1915]
    weights.push_back({name, r, std::tanh(std::atanh(r) - half), std::tanh(std::atanh(r) + half),
                       static_cast<int>(trials.size())});
  }
  return weights;
}

std::optional<Trend> trend_of(const StudyTask& task, const Trials& trials,
                              const std::vector<double>& expected) {
  if (trials.size() < kLeastAnswers) return std::nullopt;
  // Score test of a slope in a logistic model with the expected answers as its offset.
  double score = 0.0;
  double information = 0.0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const double time = static_cast<double>(i) / static_cast<double>(trials.size() - 1) - 0.5;
    const double residual = (is_correct(task, *trials[i]) ? 1.0 : 0.0) - expected[i];
    score += time * residual;
    information += time * time * expected[i] * (1.0 - expected[i]);
  }
  if (!(information > 0.0)) return std::nullopt;
  return Trend{score / information, score / std::sqrt(information)};
}

void flag_person(const Study& study, const Participant& person, const std::vector<TaskResult>& names,
                 PersonResult& result) {
  constexpr double kLapses = 0.75;
  flag_answers(counted_trials(study, person), result);
  if (result.lapses_often > kLapses) result.flags.emplace_back("lapses often");
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    flag_chance(study.tasks[task], result.tasks[task], result.flags);
    flag_fits(study, task, result.tasks[task], names[task], result.flags);
    flag_course(study.tasks[task], result.tasks[task], result.flags);
  }
  if (result.heard) {
    result.flags.push_back(fmt::format("hears the noise: {} of {} correct with the hand off the device",
                                       result.audible->counted, result.audible->trials));
  }
  flag_preparation(study, person, result);
  exclude(study, result);
}

}  // namespace palpate::study
