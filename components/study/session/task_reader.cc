#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "palpate/error.h"

#include "study/session/study_tables.h"

namespace palpate::study {
namespace {

using scene::Range;
using scene::TomlTable;

constexpr double kMilli = 1e-3;              // m/mm, N/mN
constexpr int kMaxTrials = 10'000;           // of an arm
constexpr std::size_t kMaxArms = 26;         // labels A to Z
constexpr Range kLengths{0.0, 200.0, true};  // mm
constexpr double kRoundingMargin = 1e-9;     // of sums and products of numbers in the file

TaskKind kind_of(const TomlTable& table) {
  const std::vector<std::string> names = task_kind_names();
  const std::optional<std::string> stated = table.text("kind");
  if (!stated) table.fail_missing("kind", "must be " + scene::alternatives(names));
  const auto found = std::find(names.begin(), names.end(), *stated);
  if (found == names.end()) fail_choice(table, "kind", *stated, names);
  return static_cast<TaskKind>(std::distance(names.begin(), found));
}

void read_press(const TomlTable& table, const Study& study, StudyTask& task) {
  constexpr double kLongest = 60.0;  // s
  task.gap = table.number("gap_s", Range{0.1, kLongest}).value_or(task.gap);
  if (task.leaves_tissue()) return;
  task.free = choice(table, "hold", {"contact", "free"}, "contact") == "free";
  if (const auto band = table.numbers("force_band_N", scene::kNotNegative)) {
    if (task.free) table.fail("force_band_N", "must be left out with hold = \"free\"");
    if (band->size() != 2 || (*band)[0] >= (*band)[1]) {
      table.fail("force_band_N", "must be two numbers [low, high], low < high");
    }
    task.band_low = (*band)[0];
    task.band_high = (*band)[1];
  }
  task.interval = table.number("interval_s", Range{0.1, kLongest}).value_or(task.interval);
  if (task.interval > study.max_continuous_noise) {
    table.fail("interval_s", fmt::format("must be at most safety.max_continuous_noise_s, {} s",
                                         shortest(study.max_continuous_noise)));
  }
}

/// A table {from, to, per_decade} of amplitudes.
void read_amplitudes(const TomlTable& table, std::string_view key, StudyTask& task) {
  const std::optional<TomlTable> range = table.table(key);
  if (!range) table.fail_missing(key, "must be { from = ..., to = ..., per_decade = ... }");
  range->allow_only({"from", "to", "per_decade"});
  constexpr Range kAmplitudes{0.01, 50e3};  // mN
  constexpr int kMaxPerDecade = 100;
  task.least = range->required_number("from", kAmplitudes) * kMilli;
  task.largest = range->required_number("to", kAmplitudes) * kMilli;
  task.steps = count(*range, "per_decade", 1, kMaxPerDecade, 20);
}

/// A table {least, largest, steps} of ratios of stiffness.
void read_ratios(const TomlTable& table, StudyTask& task) {
  const std::optional<TomlTable> range = table.table("ratio");
  if (!range) table.fail_missing("ratio", "must be { least = ..., largest = ..., steps = ... }");
  range->allow_only({"least", "largest", "steps"});
  constexpr Range kRatios{1.001, 100.0};
  constexpr int kMaxSteps = 100;
  task.least = range->required_number("least", kRatios);
  task.largest = range->required_number("largest", kRatios);
  task.steps = count(*range, "steps", 2, kMaxSteps, 14);
}

void read_signal(const TomlTable& table, const Study& /*study*/, StudyTask& task) {
  if (!table.has("signal")) return read_amplitudes(table, "force_mN", task);
  for (const char* key : {"force_mN", "method"}) {
    if (table.has(key)) table.fail(key, "must be left out with `signal`, which fixes the force");
  }
  const TomlTable signal = *table.table("signal");
  signal.allow_only({"from_task", "correct"});
  task.signal.emplace();
  const std::optional<std::string> source = signal.text("from_task");
  if (!source) signal.fail_missing("from_task", "must be a force-detection task with force_mN");
  task.signal->task = *source;
  constexpr Range kCorrect{0.51, 0.99};  // between chance and certainty in two intervals
  task.signal->correct = signal.number("correct", kCorrect).value_or(task.signal->correct);
  task.method = Method::kConstant;
}

void read_noise_threshold(const TomlTable& table, const Study& study, StudyTask& task) {
  read_amplitudes(table, "sigma_mN", task);
  if (task.largest > study.max_noise * (1.0 + kRoundingMargin)) {
    table.table("sigma_mN")
        ->fail("to",
               fmt::format("must be at most safety.max_noise_N, {} mN", shortest(study.max_noise / kMilli)));
  }
  task.sets_threshold = !choice(table, "sets_share_of", {"threshold"}, "").empty();
  task.each_session = table.truth("each_session").value_or(false);
  if (task.each_session && !task.sets_threshold) {
    table.fail("each_session", "needs sets_share_of = \"threshold\": it sets the noise of each session");
  }
}

void read_stiffness(const TomlTable& table, const Study& /*study*/, StudyTask& task) {
  constexpr Range kStiffness{0.1, 1e4};  // N/m
  read_ratios(table, task);
  task.standard_k1 = table.number("standard_k1_N_per_m", kStiffness).value_or(task.standard_k1);
  task.depth = table.number("depth_mm", kLengths).value_or(0.0) * kMilli;
}

void read_inclusion(const TomlTable& table, const Study& /*study*/, StudyTask& task) {
  read_ratios(table, task);
  constexpr Range kSearch{1.0, 600.0};  // s
  task.depth = table.required_number("depth_mm", kLengths) * kMilli;
  task.radius = table.number("radius_mm", kLengths).value_or(task.radius / kMilli) * kMilli;
  task.search_time = table.number("search_s", kSearch).value_or(task.search_time);
}

void read_targets(const TomlTable& table, const Study& study, StudyTask& task) {
  const auto targets = table.numbers("target_N", scene::kPositive);
  if (!targets) table.fail_missing("target_N", "must be a list of forces [a, b, ...]");
  if (targets->size() > kMaxArms) table.fail("target_N", fmt::format("must be at most {}", kMaxArms));
  if (*std::max_element(targets->begin(), targets->end()) >= study.max_force) {
    table.fail("target_N",
               fmt::format("each must be below safety.max_force_N, {} N", shortest(study.max_force)));
  }
  constexpr int kMaxRepeats = 100;
  task.targets = *targets;
  task.repeats = count(table, "repeats", 1, kMaxRepeats, 5);
  task.trials = static_cast<int>(task.targets.size()) * task.repeats;
}

std::vector<Arm> arms_of_shares(const TomlTable& table) {
  constexpr Range kShares{0.0, 10.0};
  std::vector<Arm> arms;
  const std::vector<double> shares = table.numbers("shares", kShares).value();
  for (const double share : shares) {
    const std::string name = shortest(share);
    const auto same = [&](const Arm& arm) { return arm.name == name; };
    if (std::any_of(arms.begin(), arms.end(), same)) table.fail("shares", name + " is listed twice");
    arms.push_back({name, share, NoiseProfile::kConstant, Arm{}.d0});
  }
  return arms;
}

std::vector<Arm> arms_of_conditions(const TomlTable& table, const Study& study) {
  std::vector<std::string> known;
  for (const Arm& condition : study.conditions) known.push_back(condition.name);
  std::vector<Arm> arms;
  const std::vector<std::string> names = table.texts("conditions").value();
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (known.empty()) table.fail("conditions", "the file has no [[condition]]");
    if (found == known.end()) fail_choice(table, "conditions", name, known);
    const auto same = [&](const Arm& arm) { return arm.name == name; };
    if (std::any_of(arms.begin(), arms.end(), same)) table.fail("conditions", name + " is listed twice");
    arms.push_back(study.conditions[static_cast<std::size_t>(std::distance(known.begin(), found))]);
  }
  return arms;
}

void read_arms(const TomlTable& table, const Study& study, StudyTask& task) {
  if (table.has("shares")) {
    if (table.has("conditions")) table.fail("conditions", "must be left out with `shares`");
    task.arms = arms_of_shares(table);
  } else if (table.has("conditions")) {
    task.arms = arms_of_conditions(table, study);
  } else {
    task.arms = {Arm{}};
  }
  if (task.arms.size() > kMaxArms) table.fail("shares", fmt::format("must be at most {}", kMaxArms));
}

void read_practice(const TomlTable& table, StudyTask& task) {
  constexpr int kMaxPractice = 1000;
  task.practice = count(table, "practice", 0, kMaxPractice, 0);
  const std::optional<TomlTable> until = table.table("practice_until");
  if (until && !task.two_intervals()) {
    table.fail("practice_until", "must be left out: a held force is neither right nor wrong");
  }
  if (until) {
    until->allow_only({"correct", "of", "most"});
    PracticeCriterion criterion;
    criterion.of = count(*until, "of", 2, kMaxPractice, criterion.of);
    criterion.correct = count(*until, "correct", 1, criterion.of, std::min(criterion.correct, criterion.of));
    criterion.most = count(*until, "most", std::max(criterion.of, task.practice), kMaxPractice,
                           std::max({criterion.most, criterion.of, task.practice}));
    task.practice_until = criterion;
  }
  const int least = std::max(task.practice, task.practice_until ? task.practice_until->of : 0);
  if (!table.has("examples")) return;
  if (!task.two_intervals()) table.fail("examples", "must be left out: no interval has an answer to show");
  task.examples = count(table, "examples", 0, kMaxPractice, 0);
  if (task.examples > least) {
    table.fail("examples", fmt::format("must be at most {}, the first practice trials", least));
  }
}

void read_trials(const TomlTable& table, StudyTask& task) {
  constexpr Range kCatchShares{0.0, 0.5};
  read_practice(table, task);
  task.repeat_at_end = table.truth("repeat_at_end").value_or(false);
  if (!task.two_intervals()) {
    if (table.has("trials")) table.fail("trials", "must be left out, it is the number of targets x repeats");
    return;
  }
  if (table.has("trials") && table.has("trials_per_level")) {
    table.fail("trials_per_level", "must be left out with `trials`, which means the same");
  }
  const char* key = table.has("trials_per_level") ? "trials_per_level" : "trials";
  task.trials = count(table, key, 1, kMaxTrials, task.trials);
  task.catch_share = table.number("catch_share", kCatchShares).value_or(0.0);
  if (task.signal) return;
  const std::string method = choice(table, "method", {"questplus", "staircase", "constant"}, "questplus");
  task.method = method == "constant"    ? Method::kConstant
                : method == "staircase" ? Method::kStaircase
                                        : Method::kQuestPlus;
}

/// The part of a study file that one kind of task has alone.
struct FileKind {
  std::vector<std::string> keys;
  void (*read)(const TomlTable& table, const Study& study, StudyTask& task);
  const char* levels = nullptr;  // key of the range of stimuli
};

const FileKind& file_kind(TaskKind kind) {
  static const std::array<FileKind, kTaskKinds> kinds{{
      // in the order of TaskKind
      {{"hold", "force_band_N", "interval_s", "gap_s", "method", "catch_share", "sigma_mN", "sets_share_of",
        "each_session"},
       read_noise_threshold,
       "sigma_mN"},
      {{"hold", "force_band_N", "interval_s", "gap_s", "method", "catch_share", "signal", "force_mN",
        "shares", "trials_per_level", "conditions"},
       read_signal,
       "force_mN"},
      {{"gap_s", "method", "catch_share", "standard_k1_N_per_m", "ratio", "depth_mm", "conditions"},
       read_stiffness,
       "ratio"},
      {{"gap_s", "method", "catch_share", "ratio", "radius_mm", "depth_mm", "search_s", "conditions"},
       read_inclusion,
       "ratio"},
      {{"target_N", "repeats", "conditions"}, read_targets},
  }};
  return kinds[static_cast<std::size_t>(kind)];
}

/// The stimuli must give a grid of levels.
void check_levels(const TomlTable& table, const StudyTask& task) {
  if (!task.two_intervals() || task.signal) return;
  const char* key = file_kind(task.kind).levels;
  const bool amplitudes = table.table(key)->has("from");
  if (task.largest <= task.least) {
    table.table(key)->fail(amplitudes ? "to" : "largest",
                           std::string("must be above `") + (amplitudes ? "from" : "least") + "`");
  }
  try {
    static_cast<void>(grid_of(task));
  } catch (const ParameterError&) {
    table.table(key)->fail(amplitudes ? "to" : "largest", "is too near to the least stimulus");
  }
}

}  // namespace

ReadTask read_task(const TomlTable& table, const Study& study) {
  StudyTask task;
  task.kind = kind_of(table);
  const FileKind& kind = file_kind(task.kind);
  std::vector<std::string> keys{"name",     "kind",          "practice", "practice_until",
                                "examples", "repeat_at_end", "trials"};
  keys.insert(keys.end(), kind.keys.begin(), kind.keys.end());
  table.allow_only(keys);
  task.name = name_in(table, "name");
  if (task.two_intervals()) read_press(table, study, task);
  kind.read(table, study, task);
  read_arms(table, study, task);
  read_trials(table, task);
  check_levels(table, task);
  return {std::move(task), table};
}

}  // namespace palpate::study
