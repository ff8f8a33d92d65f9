#include "study/session/power.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/json_text.h"
#include "palpate/error.h"
#include "run/tasks/for_each_task.h"

#include "study/psychophysics/comparisons.h"
#include "study/psychophysics/simulated_group.h"
#include "study/session/analysis.h"
#include "study/session/analysis_parts.h"
#include "study/session/simulate.h"
#include "study/session/simulated_person.h"

namespace palpate::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUsualRatio = 0.85;
constexpr double kUsualNoise = 0.4;
constexpr int kMaxPeople = 500;
constexpr int kMaxGroups = 10'000;

// The analysis of one simulated group.
struct Outcome {
  bool found = false;
  double effect = 0.0;
  double width = 0.0;
};

Json json_of(const Outcome& outcome) { return Json::array({outcome.found, outcome.effect, outcome.width}); }

bool has_jnd(const Study& study) { return study.primary && study.primary->measure == "ln_jnd"; }

void check(const Study& study, const PowerRequest& request) {
  const auto fail = [](const std::string& what) { throw InputError(what); };
  if (request.groups < 2 || request.groups > kMaxGroups) {
    fail(fmt::format("--groups = {}, must be 2 to {}", request.groups, kMaxGroups));
  }
  for (const int people : request.participants) {
    if (people >= 2 && people <= kMaxPeople) continue;
    fail(fmt::format("--participants = {}, must be 2 to {}", people, kMaxPeople));
  }
  if (request.participants.empty()) fail("--participants: missing, must be numbers such as 12,16,24");
  if (request.jnd_ratio) {
    if (!(*request.jnd_ratio >= 0.3 && *request.jnd_ratio <= 3.0)) {
      fail(fmt::format("--effect jnd = {}, must be 0.3 to 3", brief(*request.jnd_ratio)));
    }
    if (!has_jnd(study)) fail("--effect jnd: needs analysis.primary of the study with measure = \"ln_jnd\"");
  }
  if (!request.internal_noise) return;
  if (!(*request.internal_noise >= 0.05 && *request.internal_noise <= 2.0)) {
    fail(fmt::format("--effect sr = {}, must be 0.05 to 2", brief(*request.internal_noise)));
  }
  if (!study.inverted_u) fail("--effect sr: needs analysis.inverted_u in the study");
}

// The largest group is simulated; smaller ones are its first people.
std::vector<Outcome> jnd_group(const Study& study, const PowerRequest& request, std::uint32_t number) {
  const StudyTask& task = study.tasks[study.find_task(study.primary->task).value()];
  psychophysics::QuestPlus quest(grid_of(task));
  const psychophysics::GroupModel model(quest.grid());
  psychophysics::SimulatedGroup group;
  group.people = *std::max_element(request.participants.begin(), request.participants.end());
  group.trials = task.trials;
  group.ratio = *request.jnd_ratio;
  group.catch_share = task.catch_share;
  group.seed = study.seed;
  const std::vector<psychophysics::PairedCounts> people = psychophysics::simulate_group(quest, group, number);
  std::vector<Outcome> outcomes;
  for (const int participants : request.participants) {
    const psychophysics::GroupEffect found =
        model.fit(std::span(people).first(static_cast<std::size_t>(participants)));
    const double p = p_of_alternative(found.p_value, found.effect, study.primary->alternative);
    outcomes.push_back({p < 0.05, found.effect, found.high - found.low});
  }
  return outcomes;
}

// The curve's task and those that it needs, in one long session without practice or repetition.
Study curve_study(const Study& study) {
  Study part = study;
  part.tasks.clear();
  const StudyTask& curve = study.tasks[study.find_task(study.inverted_u->task).value()];
  for (const StudyTask& task : study.tasks) {
    const bool needed =
        task.sets_threshold || task.name == curve.name || (curve.signal && task.name == curve.signal->task);
    if (!needed) continue;
    part.tasks.push_back(task);
    part.tasks.back().practice = 0;
    part.tasks.back().repeat_at_end = false;
  }
  part.sessions = 1;
  part.max_minutes = 1e9;
  part.primary.reset();
  return part;
}

std::vector<Outcome> curve_group(const Study& part, const PowerRequest& request, std::uint32_t number) {
  const std::uint64_t seed = part.seed + (static_cast<std::uint64_t>(number) + 1) * 0x1'0000'0001U;
  const int most = *std::max_element(request.participants.begin(), request.participants.end());
  Study own = part;
  own.seed = seed;
  std::vector<Participant> people;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(most); ++i) {
    SimulatedPerson person = make_person("sr", seed, i);
    person.observer.internal_noise = *request.internal_noise;
    person.observer.lapse = person.lapse;
    people.push_back({i, simulate_trials(own, seed, i, std::move(person))});
  }
  std::vector<Outcome> outcomes;
  for (const int participants : request.participants) {
    const std::span<const Participant> first =
        std::span(people).first(static_cast<std::size_t>(participants));
    const StudyAnalysis analysis = analyse(part, first, seed, true);
    if (analysis.curves.empty()) {
      outcomes.emplace_back();
      continue;
    }
    const Curve& curve = analysis.curves.front();
    const psychophysics::PairedTest& rise = curve.inverted_u->rise;
    outcomes.push_back({curve.found, rise.mean, rise.high - rise.low});
  }
  return outcomes;
}

// The rows of one effect, from the results of its groups.
std::vector<PowerRow> rows_of(const std::string& effect, const std::string& analysis,
                              const PowerRequest& request, const std::vector<std::string>& results,
                              std::size_t first) {
  std::vector<PowerRow> rows;
  for (std::size_t i = 0; i < request.participants.size(); ++i) {
    PowerRow row;
    row.effect = effect;
    row.analysis = analysis;
    row.participants = request.participants[i];
    for (int group = 0; group < request.groups; ++group) {
      const Json outcome = parse_json(results[first + static_cast<std::size_t>(group)]).at(i);
      row.power += (outcome[0].get<bool>() ? 1.0 : 0.0) / request.groups;
      row.mean_effect += outcome[1].get<double>() / request.groups;
      row.width += outcome[2].get<double>() / request.groups;
    }
    row.error = std::sqrt(row.power * (1.0 - row.power) / request.groups);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Power simulate_power(const Study& study, PowerRequest request, tasks::Communicator* ranks,
                     const std::function<void(double)>& progress) {
  if (!request.jnd_ratio && !request.internal_noise) {
    if (has_jnd(study)) request.jnd_ratio = kUsualRatio;
    if (study.inverted_u) request.internal_noise = kUsualNoise;
    if (!request.jnd_ratio && !request.internal_noise) {
      throw InputError(study.file.string() +
                       ": analysis: has neither a primary analysis of ln_jnd nor inverted_u; `study power` "
                       "simulates these two");
    }
  }
  check(study, request);
  const auto groups = static_cast<std::size_t>(request.groups);
  const std::size_t jnd_groups = request.jnd_ratio ? groups : 0;
  const Study part = request.internal_noise ? curve_study(study) : Study{};
  std::size_t finished = 0;
  tasks::Tasks all;
  all.count = jnd_groups + (request.internal_noise ? groups : 0);
  all.run = [&](std::size_t i) {
    const auto number = static_cast<std::uint32_t>(i % groups);
    Json json = Json::array();
    for (const Outcome& outcome :
         i < jnd_groups ? jnd_group(study, request, number) : curve_group(part, request, number)) {
      json.push_back(json_of(outcome));
    }
    return json.dump();
  };
  all.on_threads = true;
  all.done = [&](std::size_t) {
    if (progress) progress(static_cast<double>(++finished) / static_cast<double>(all.count));
  };
  const std::vector<std::string> results = tasks::for_each_task(ranks, all).results;
  Power power;
  power.groups = request.groups;
  if (request.jnd_ratio) {
    power.rows = rows_of("jnd=" + brief(*request.jnd_ratio),
                         fmt::format("JND in {}, {} - {}, {}", study.primary->task, study.primary->condition,
                                     study.primary->reference,
                                     study.primary->alternative == "two-sided"
                                         ? "two-sided test at 5 %"
                                         : "one-sided test at 5 % (" + study.primary->alternative + ")"),
                         request, results, 0);
  }
  if (request.internal_noise) {
    std::ranges::move(rows_of("sr=" + brief(*request.internal_noise),
                              fmt::format("inverted U in {}, two one-sided tests at {}",
                                          study.inverted_u->task, percent(study.inverted_u->alpha, 0)),
                              request, results, jnd_groups),
                      std::back_inserter(power.rows));
  }
  for (const PlannedSession& session : plan_sessions(study)) power.hours_per_person += session.minutes / 60.0;
  return power;
}

}  // namespace palpate::study
