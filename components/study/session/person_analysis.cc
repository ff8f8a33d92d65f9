#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"

#include "study/session/analysis_parts.h"
#include "study/session/course.h"

namespace palpate::study {
namespace {

using psychophysics::Count;
using psychophysics::Estimate;
using psychophysics::Parameters;
using psychophysics::QuestPlus;

constexpr double kSameLevel = 1e-9;
constexpr std::size_t kLeastHalf = 10;  // trials of a half that is fitted alone

// Probability that the fitted function lies at the end of the grid.
bool at_edge(const QuestPlus& quest) {
  constexpr double kThresholdEdge = 0.01;
  constexpr double kSpreadEdge = 0.05;  // the prior alone has 0.015 there
  const psychophysics::QuestPlusGrid& grid = quest.grid();
  if (grid.function.shape == psychophysics::PsychometricFunction::Shape::kWeibull) {
    return quest.edge_probability() > kThresholdEdge;
  }
  double first = 0.0;
  double last = 0.0;
  const std::size_t spreads = grid.spread.values.size();
  const std::size_t lapses = grid.lapse.values.size();
  for (std::size_t cell = 0; cell < quest.posterior().size(); ++cell) {
    const std::size_t spread = cell / lapses % spreads;
    if (spread == 0) first += quest.posterior()[cell];
    if (spread + 1 == spreads) last += quest.posterior()[cell];
  }
  return std::max(first, last) > kSpreadEdge;
}

void count_answer(Count& count, bool counted) {
  ++count.trials;
  count.counted += counted ? 1 : 0;
}

std::vector<Point> points_of(const Trials& trials) {
  std::map<double, Count> counts;
  for (const TrialRecord* trial : trials) count_answer(counts[trial->level], trial->counted);
  std::vector<Point> points;
  for (const auto& [level, count] : counts) points.push_back({level, count});
  return points;
}

// The trials of one task.
struct SortedTrials {
  Trials all;                                   // that count, without the repetition
  std::vector<std::size_t> arms;                // of `all`
  std::vector<Trials> main, repeated, spoiled;  // of each arm
  std::map<int, Trials> starts;                 // runs at the start of later sessions
};

ArmResult analyse_arm(const StudyTask& task, const Trials& main, QuestPlus* quest) {
  ArmResult arm;
  arm.trials = static_cast<int>(main.size());
  std::vector<double> times;
  std::vector<double> errors;
  std::vector<double> variations;
  for (const TrialRecord* trial : main) {
    times.push_back(trial->response_time);
    if (task.two_intervals()) {
      count_answer(target_second(task, *trial) ? arm.in_second : arm.in_first, is_correct(task, *trial));
    } else if (trial->rms_error > 0.0 && trial->variation > 0.0) {
      errors.push_back(std::log(trial->rms_error));
      variations.push_back(std::log(trial->variation));
    }
  }
  arm.response_time = median(times);
  if (!errors.empty()) arm.ln_rms = mean(errors);
  if (!variations.empty()) arm.ln_variation = mean(variations);
  if (!task.two_intervals()) return arm;
  arm.points = points_of(main);
  if (arm.in_first.trials > 0 && arm.in_second.trials > 0) {
    arm.sensitivity = psychophysics::two_interval(arm.in_first, arm.in_second, true);
  }
  if (quest == nullptr) return arm;
  arm.fit = fit_trials(*quest, task, main);
  const auto middle = main.begin() + static_cast<std::ptrdiff_t>(main.size() / 2);
  if (main.size() >= 2 * kLeastHalf) {
    arm.first_half = fit_trials(*quest, task, {main.begin(), middle});
    arm.second_half = fit_trials(*quest, task, {middle, main.end()});
  }
  return arm;
}

// Probability of a correct answer that the person's own fits predict for each trial.
std::vector<double> expected_correct(const StudyTask& task, const Trials& trials, const PersonTask& result,
                                     const std::vector<std::size_t>& arms, const QuestPlus* quest) {
  std::vector<double> expected;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const ArmResult& arm = result.arms[arms[i]];
    if (quest == nullptr || !arm.fit) {
      const int correct = arm.in_first.counted + arm.in_second.counted;
      expected.push_back(static_cast<double>(correct) / arm.trials);
      continue;
    }
    const double counted = quest->grid().function(trials[i]->level, arm.fit->function);
    expected.push_back(task.comparison() && trials[i]->level < 0.0 ? 1.0 - counted : counted);
  }
  return expected;
}

// The lapse rate is the same in all tasks: its posterior is prior x product of posterior/prior of all fits.
double lapses_often(const std::vector<PersonTask>& tasks, const psychophysics::GridAxis& axis) {
  constexpr double kOften = 0.05;
  double often = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    double probability = axis.weights[i];
    for (const PersonTask& task : tasks) {
      for (const ArmResult& arm : task.arms) {
        if (arm.fit) probability *= arm.fit->lapses[i] / axis.weights[i];
      }
    }
    all += probability;
    if (axis.values[i] >= kOften) often += probability;
  }
  return often / all;
}

// d' of each half of the trials at a level: the even and the odd ones of their order.
std::array<double, 2> halves_of(const StudyTask& task, const Trials& trials) {
  std::array<std::array<Count, 2>, 2> counts{};
  for (std::size_t i = 0; i < trials.size(); ++i) {
    count_answer(counts[i % 2][target_second(task, *trials[i]) ? 1 : 0], is_correct(task, *trials[i]));
  }
  std::array<double, 2> halves{};
  for (std::size_t half = 0; half < 2; ++half) {
    for (Count& count : counts[half]) {
      if (count.trials == 0) count = {2, 1};  // by chance: nothing is known
    }
    halves[half] = psychophysics::two_interval(counts[half][0], counts[half][1], true).d_prime;
  }
  return halves;
}

PersonTask analyse_task(const StudyTask& task, const SortedTrials& sorted, QuestPlus* quest) {
  PersonTask result;
  for (std::size_t i = 0; i < task.arms.size(); ++i) {
    ArmResult arm = analyse_arm(task, sorted.main[i], quest);
    if (quest != nullptr) arm.repeated = fit_trials(*quest, task, sorted.repeated[i]);
    arm.spoiled = static_cast<int>(sorted.spoiled[i].size());
    for (const TrialRecord* trial : sorted.spoiled[i]) {
      for (const std::string& reason : trial->spoiled) ++arm.reasons[reason];
    }
    result.arms.push_back(std::move(arm));
  }
  if (!task.two_intervals()) return result;
  if (task.sets_threshold && result.arms.front().fit) {
    result.thresholds.push_back({sorted.main.front().front()->session, *result.arms.front().fit});
    for (const auto& [session, trials] : sorted.starts) {
      result.thresholds.push_back({session, fit_trials(*quest, task, trials).value()});
    }
  }
  result.trend = trend_of(task, sorted.all, expected_correct(task, sorted.all, result, sorted.arms, quest));
  if (task.comparison()) result.cues = cue_weights(sorted.all);
  return result;
}

std::size_t task_of(const Study& study, const std::string& id, const TrialRecord& trial) {
  const std::optional<std::size_t> task = study.find_task(trial.task);
  if (!task) throw InputError(id + ": task = `" + trial.task + "` is not in the study file");
  return *task;
}

std::vector<SortedTrials> sort_trials(const Study& study, const Participant& person, const ArmNames& names) {
  std::vector<SortedTrials> sorted(study.tasks.size());
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    sorted[task].main.resize(study.tasks[task].arms.size());
    sorted[task].repeated = sorted[task].spoiled = sorted[task].main;
  }
  for (const TrialRecord& trial : person.log.trials) {
    if (trial.practice) continue;
    SortedTrials& task = sorted[task_of(study, person.log.id, trial)];
    const std::size_t index = static_cast<std::size_t>(&task - sorted.data());
    const std::size_t arm = names.index_of(person.number, index, trial.code);
    const bool starts = study.tasks[index].each_session && trial.repeat && !task.main[arm].empty() &&
                        trial.session > task.main[arm].front()->session;
    if (starts && trial.spoiled.empty()) {
      task.starts[trial.session].push_back(&trial);
      continue;
    }
    // The level is not that of the signal: such a trial is no part of d'.
    if (study.tasks[index].signal && trial.catch_trial && trial.spoiled.empty()) continue;
    std::vector<Trials>& group = !trial.spoiled.empty() ? task.spoiled
                                 : trial.repeat         ? task.repeated
                                                        : task.main;
    group[arm].push_back(&trial);
    if (&group != &task.main) continue;
    task.all.push_back(&trial);
    task.arms.push_back(arm);
  }
  return sorted;
}

void count_trials(const Study& study, const ParticipantLog& log, PersonResult& result) {
  for (const TrialRecord& trial : log.trials) {
    if (!trial.observer.empty()) result.observer = trial.observer;
    if (trial.practice) continue;
    ++(trial.spoiled.empty() ? result.trials : result.spoiled);
    if (!trial.catch_trial || !trial.spoiled.empty()) continue;
    count_answer(result.catch_trials, is_correct(study.tasks[task_of(study, log.id, trial)], trial));
  }
}

double minutes_of(const ParticipantLog& log) {
  std::map<int, std::pair<double, double>> sessions;
  for (const TrialRecord& trial : log.trials) {
    const double time = seconds_of(trial.time);
    const auto [found, added] = sessions.try_emplace(trial.session, time, time);
    if (!added) found->second.second = time;
  }
  double sum = 0.0;
  for (const auto& [session, span] : sessions) sum += span.second - span.first;
  return sum / 60.0;
}

// A share is of the first estimate; the best one is of all trials, or of those of its session where each one
// has its own.
std::optional<Estimate> share_reached(const Study& study, const Participant& person, PersonResult& result,
                                      std::vector<std::optional<QuestPlus>>& quests) {
  const std::optional<std::size_t> task = study.threshold_task();
  if (!task || result.tasks[*task].arms.empty() || !is_number(result.tasks[*task].arms.front().fit)) {
    return std::nullopt;
  }
  Trials all;
  for (const TrialRecord& trial : person.log.trials) {
    const bool other =
        study.tasks[*task].each_session && !all.empty() && trial.session != all.front()->session;
    if (trial.task == study.tasks[*task].name && !trial.practice && trial.spoiled.empty() && !other) {
      all.push_back(&trial);
    }
  }
  const std::optional<ThresholdFit> fit = fit_trials(*quests[*task], study.tasks[*task], all);
  if (!is_number(fit)) return std::nullopt;
  const double used = result.tasks[*task].arms.front().fit->estimate.mean;
  const Estimate& best = fit->estimate;
  return Estimate{used - best.mean, best.sd, used - best.high, used - best.low};
}

/// Adds a count of an event, which may lack it. @throws InputError
void add_count(const EventRecord& event, const char* name, int& sum) {
  const std::string text = event.value(name);
  if (text.empty()) return;
  const std::optional<double> count = parse_number(text);
  const double most = std::numeric_limits<int>::max() - static_cast<double>(sum);
  if (!count || !(*count >= 0.0 && *count <= most) || *count != std::floor(*count)) {
    throw InputError(fmt::format("a log's event {}: {} = \"{}\": must be a whole number from 0 to {}",
                                 one_line(event.event), name, excerpt(text), most));
  }
  sum += static_cast<int>(*count);
}

void count_events(const ParticipantLog& log, PersonResult& result) {
  for (const EventRecord& event : log.events) {
    if (event.event == "block") {
      add_count(event, "late_ticks", result.late_ticks);
      add_count(event, "faults", result.faults);
    } else if (event.event == "audible") {
      if (!result.audible) result.audible.emplace();
      add_count(event, "trials", result.audible->trials);
      add_count(event, "correct", result.audible->counted);
    }
  }
  if (result.audible && result.audible->trials > 0) {
    result.heard = 4.0 * result.audible->counted >= 3.0 * result.audible->trials;
  }
}

}  // namespace

std::optional<double> own_level_gain(const StudyTask& task, const std::vector<Trials>& arms) {
  constexpr std::size_t kLeast = 20;
  std::vector<std::array<double, 2>> levels;
  std::array<double, 2> off{};
  for (std::size_t arm = 0; arm < arms.size(); ++arm) {
    if (arms[arm].size() < kLeast) return std::nullopt;
    const std::array<double, 2> halves = halves_of(task, arms[arm]);
    if (task.arms[arm].share == 0.0) {
      off = halves;
    } else {
      levels.push_back(halves);
    }
  }
  double gain = 0.0;
  for (const std::size_t chosen : {0U, 1U}) {
    const auto own = std::max_element(levels.begin(), levels.end(),
                                      [&](const auto& a, const auto& b) { return a[chosen] < b[chosen]; });
    gain += 0.5 * ((*own)[1 - chosen] - off[1 - chosen]);
  }
  return gain;
}

psychophysics::QuestPlusGrid grid_with_levels(const StudyTask& task, std::span<const Participant> people) {
  psychophysics::QuestPlusGrid grid = grid_of(task);
  for (const Participant& person : people) {
    for (const TrialRecord& trial : person.log.trials) {
      if (trial.task != task.name || trial.practice) continue;
      const auto near = std::lower_bound(grid.levels.begin(), grid.levels.end(), trial.level - kSameLevel);
      if (near == grid.levels.end() || *near > trial.level + kSameLevel)
        grid.levels.insert(near, trial.level);
    }
  }
  return grid;
}

bool has_function(const StudyTask& task) noexcept { return task.two_intervals() && !task.signal; }

std::optional<ThresholdFit> fit_trials(QuestPlus& quest, const StudyTask& task, const Trials& trials) {
  if (trials.empty()) return std::nullopt;
  quest.reset();
  const std::vector<double>& levels = quest.grid().levels;
  for (const TrialRecord* trial : trials) {
    const auto level = std::lower_bound(levels.begin(), levels.end(), trial->level - kSameLevel);
    quest.update(static_cast<std::size_t>(level - levels.begin()), trial->counted);
  }
  ThresholdFit fit;
  fit.trials = static_cast<int>(trials.size());
  fit.estimate =
      quest.estimate(task.comparison() ? psychophysics::log10_difference_of : psychophysics::threshold_of);
  const auto mean_of = [&](double Parameters::*member) {
    return quest.estimate([member](const Parameters& at) { return at.*member; }).mean;
  };
  fit.function = {mean_of(&Parameters::location), mean_of(&Parameters::spread), mean_of(&Parameters::lapse)};
  fit.range_too_small = at_edge(quest);
  const std::size_t lapses = quest.grid().lapse.values.size();
  fit.lapses.resize(lapses);
  for (std::size_t cell = 0; cell < quest.posterior().size(); ++cell) {
    fit.lapses[cell % lapses] += quest.posterior()[cell];
  }
  return fit;
}

PersonResult analyse_person(const Study& study, const Participant& person, const ArmNames& names,
                            std::vector<std::optional<QuestPlus>>& quests) {
  PersonResult result;
  result.id = person.log.id;
  result.withdrawn = person.log.withdrawn();
  if (result.withdrawn) return result;
  const std::vector<SortedTrials> sorted = sort_trials(study, person, names);
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    QuestPlus* quest = quests[task] ? &*quests[task] : nullptr;
    result.tasks.push_back(analyse_task(study.tasks[task], sorted[task], quest));
    if (names.unblinded() && study.tasks[task].name == study.own_level) {
      result.tasks.back().own_level_gain = own_level_gain(study.tasks[task], sorted[task].main);
    }
  }
  const auto fitted = std::find_if(quests.begin(), quests.end(), [](const auto& quest) { return quest; });
  if (fitted != quests.end()) {
    result.lapses_often = lapses_often(result.tasks, (*fitted)->grid().lapse);  // the axis of all grids
  }
  count_trials(study, person.log, result);
  result.minutes = minutes_of(person.log);
  count_events(person.log, result);
  result.reached = share_reached(study, person, result, quests);
  flag_person(study, person, names.tasks(), result);
  return result;
}

}  // namespace palpate::study
