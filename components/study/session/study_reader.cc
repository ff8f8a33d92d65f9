#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/system/file_content.h"
#include "io/system/input_file.h"
#include "palpate/error.h"

#include "study/session/markers.h"
#include "study/session/study_tables.h"

namespace palpate::study {
namespace {

using scene::Range;
using scene::TomlTable;

constexpr std::size_t kMaxTables = 50;  // tasks or conditions
constexpr std::size_t kLongestName = 40;

/// The table of a key, after a check of its keys; an empty one when the file lacks it.
TomlTable table_or_empty(const TomlTable& root, std::string_view key, const std::vector<std::string>& keys) {
  static const toml::table kEmpty;
  std::optional<TomlTable> table = root.table(key);
  if (!table) return {"", std::string(key), kEmpty, 1};
  table->allow_only(keys);
  return *table;
}

void read_study_table(const TomlTable& root, Study& study) {
  const std::optional<TomlTable> table = root.table("study");
  if (!table) root.fail_missing("study", "must be a table [study] with name and scene");
  table->allow_only({"name", "scene", "seed", "sessions", "max_minutes", "task_order", "calibration"});
  study.name = name_in(*table, "name");
  const std::optional<std::string> scene = table->text("scene");
  if (!scene) table->fail_missing("scene", "must be a scene file or a built-in organ");
  study.scene = *scene;
  study.seed = table->whole_number("seed").value_or(study.seed);
  constexpr int kMaxSessions = 50;
  constexpr Range kMinutes{5.0, 480.0};
  study.sessions = count(*table, "sessions", 1, kMaxSessions, study.sessions);
  study.max_minutes = table->number("max_minutes", kMinutes).value_or(study.max_minutes);
  study.latin_order = choice(*table, "task_order", {"file", "latin-square"}, "file") == "latin-square";
  study.calibration_file = table->text("calibration").value_or("");
  if (study.calibration_file.empty()) return;
  if (study.calibration_file.find('/') != std::string::npos) {
    table->fail("calibration", "must be a file beside the study file, without a folder");
  }
  study.calibration = read_calibration(study.file.parent_path() / study.calibration_file);
}

void read_people(const TomlTable& root, Study& study) {
  const TomlTable ethics = table_or_empty(root, "ethics", {"consent_file", "approval", "withdraw_key"});
  study.consent_file = ethics.text("consent_file").value_or("");
  study.approval = ethics.text("approval").value_or("");
  study.withdraw_key = ethics.text("withdraw_key").value_or("F12");
  const TomlTable people = table_or_empty(root, "participants", {"id", "ask"});
  study.random_ids = choice(people, "id", {"random", "numbered"}, "random") == "random";
  study.ask = people.texts("ask").value_or(std::vector<std::string>{});
  const std::vector<std::string> known{"age_band", "hand", "palpation_experience_years"};
  for (const std::string& question : study.ask) {
    if (std::find(known.begin(), known.end(), question) == known.end()) {
      fail_choice(people, "ask", question, known);
    }
  }
}

void read_safety(const TomlTable& root, Study& study) {
  const TomlTable table =
      table_or_empty(root, "safety", {"max_force_N", "max_noise_N", "max_continuous_noise_s"});
  constexpr Range kForces{0.0, scene::SafetySetup::kMaxForce, true};  // N
  constexpr Range kTimes{0.1, 60.0};                                  // s
  study.max_force = table.number("max_force_N", kForces).value_or(study.max_force);
  study.max_noise = table.number("max_noise_N", kForces).value_or(study.max_noise);
  study.max_continuous_noise =
      table.number("max_continuous_noise_s", kTimes).value_or(study.max_continuous_noise);
}

void read_screen_and_sound(const TomlTable& root, Study& study) {
  const TomlTable screen = table_or_empty(root, "screen", {"participant", "experimenter", "language"});
  const std::string language = screen.text("language").value_or("en");
  if (language.ends_with(".toml")) {
    if (language.find('/') != std::string::npos) {
      screen.fail("language", "must be a file beside the study file, without a folder");
    }
    study.language_file = language;
    const std::filesystem::path file = study.file.parent_path() / language;
    study.language = read_language(InputFile(file, kTomlInput).read_rest(), file.string());
  } else {
    const std::vector<std::string> known = builtin_languages();
    if (std::find(known.begin(), known.end(), language) == known.end())
      fail_choice(screen, "language", language, known);
    study.language = builtin_language(language);
  }
  static_cast<void>(choice(screen, "participant", {"blank"}, "blank"));
  study.experimenter_screen =
      choice(screen, "experimenter", {"second-display", "file", "none"}, "second-display");
  const TomlTable sound = table_or_empty(root, "sound", {"mask", "level_dB", "mask_dBA", "motors_dBA"});
  constexpr Range kLevels{-80.0, 0.0};  // dB
  study.sound_mask = choice(sound, "mask", {"pink", "white", "none"}, "pink");
  study.sound_level_dB = sound.number("level_dB", kLevels).value_or(study.sound_level_dB);
  constexpr Range kHeard{0.0, 140.0};  // dB(A)
  study.mask_dBA = sound.number("mask_dBA", kHeard);
  study.motors_dBA = sound.number("motors_dBA", kHeard);
}

void read_markers(const TomlTable& root, Study& study) {
  const TomlTable table = table_or_empty(root, "markers", {"to"});
  study.markers = table.texts("to").value_or(std::vector<std::string>{});
  for (const std::string& text : study.markers) {
    static_cast<void>(parse_marker_target(text, study.file.string() + ": markers.to"));
  }
}

void read_response(const TomlTable& root, Study& study) {
  const TomlTable table =
      table_or_empty(root, "response", {"first", "second", "device_button", "timeout_s", "feedback"});
  study.first_keys = table.texts("first").value_or(std::vector<std::string>{"1", "f"});
  study.second_keys = table.texts("second").value_or(std::vector<std::string>{"2", "j"});
  for (const std::string& key : study.second_keys) {
    if (std::find(study.first_keys.begin(), study.first_keys.end(), key) == study.first_keys.end()) continue;
    table.fail("second", "\"" + key + "\" is also in `first`, must be in one of them");
  }
  constexpr Range kTimes{0.5, 120.0};  // s
  study.next_button =
      static_cast<std::uint32_t>(count(table, "device_button", 0, static_cast<int>(scene::kLastButton), 0));
  study.timeout = table.number("timeout_s", kTimes).value_or(study.timeout);
  study.feedback = choice(table, "feedback", {"never", "practice", "always"}, "practice");
}

void read_pace(const TomlTable& root, Study& study) {
  constexpr double kMilli = 1e-3;            // m/mm
  constexpr Range kRadii{0.1, 200.0};        // mm
  constexpr Range kStillTimes{0.0, 10.0};    // s
  constexpr Range kMinutes{0.5, 120.0};      // min
  constexpr Range kBreakTimes{0.0, 1800.0};  // s
  constexpr int kMaxTrials = 1000;           // between breaks
  const TomlTable homing = table_or_empty(root, "homing", {"place", "radius_mm", "still_s"});
  static_cast<void>(choice(homing, "place", {"rest"}, "rest"));
  study.homing_radius = homing.number("radius_mm", kRadii).value_or(study.homing_radius / kMilli) * kMilli;
  study.homing_still = homing.number("still_s", kStillTimes).value_or(study.homing_still);
  const TomlTable breaks = table_or_empty(root, "breaks", {"every_trials", "every_minutes", "least_s"});
  study.break_trials = count(breaks, "every_trials", 1, kMaxTrials, study.break_trials);
  study.break_minutes = breaks.number("every_minutes", kMinutes).value_or(study.break_minutes);
  study.break_least = breaks.number("least_s", kBreakTimes).value_or(study.break_least);
}

std::vector<TomlTable> tables_of(const TomlTable& root, std::string_view key) {
  std::vector<TomlTable> tables = root.tables(key);
  if (tables.size() > kMaxTables) root.fail(key, fmt::format("must be at most {} tables", kMaxTables));
  return tables;
}

void read_conditions(const TomlTable& root, Study& study) {
  constexpr double kMilli = 1e-3;            // m/mm
  constexpr double kContactReach = 2e-5;     // m: 1 mm from the tissue a fiftieth of the noise is left
  constexpr Range kShares{0.0, 10.0};        // of the threshold
  constexpr Range kLengths{0.0, 1e3, true};  // mm
  for (const TomlTable& table : tables_of(root, "condition")) {
    table.allow_only({"name", "share", "profile", "d0_mm"});
    Arm arm;
    arm.name = name_in(table, "name");
    for (const Arm& other : study.conditions) {
      if (other.name == arm.name) table.fail("name", "is the name of an earlier condition, must be another");
    }
    arm.share = table.required_number("share", kShares);
    const bool proximity =
        choice(table, "profile", {"constant", "proximity", "contact"}, "constant") == "proximity";
    const bool contact = table.text("profile") == "contact";
    arm.profile = proximity || contact ? NoiseProfile::kProximity : NoiseProfile::kConstant;
    if (contact) arm.d0 = kContactReach;
    if (!proximity && table.has("d0_mm")) table.fail("d0_mm", "needs profile = \"proximity\"");
    if (proximity) arm.d0 = table.number("d0_mm", kLengths).value_or(arm.d0 / kMilli) * kMilli;
    study.conditions.push_back(arm);
  }
}

void read_checks(const TomlTable& root, Study& study) {
  for (const TomlTable& table : tables_of(root, "check")) {
    table.allow_only({"kind"});
    if (!table.has("kind")) table.fail_missing("kind", "must be audible or blinding");
    const bool audible = choice(table, "kind", {"audible", "blinding"}, "") == "audible";
    (audible ? study.check_audible : study.check_blinding) = true;
  }
}

const StudyTask& task_in(const TomlTable& table, const Study& study) {
  const std::optional<std::string> name = table.text("task");
  std::vector<std::string> known;
  for (const StudyTask& task : study.tasks) known.push_back(task.name);
  if (!name) table.fail_missing("task", "must be " + scene::alternatives(known));
  const std::optional<std::size_t> found = study.find_task(*name);
  if (!found) fail_choice(table, "task", *name, known);
  return study.tasks[*found];
}

std::vector<std::string> arm_names(const StudyTask& task) {
  std::vector<std::string> names;
  for (const Arm& arm : task.arms) names.push_back(arm.name);
  return names;
}

void read_primary(const TomlTable& table, Study& study) {
  table.allow_only({"task", "contrast", "measure", "alternative"});
  const StudyTask& task = task_in(table, study);
  PrimaryAnalysis primary;
  primary.task = task.name;
  if (task.arms.size() < 2) table.fail("task", "must be a task with two or more conditions");
  const std::string form =
      "must be \"CONDITION - REFERENCE\", two different ones of " + scene::alternatives(arm_names(task));
  const std::optional<std::string> contrast = table.text("contrast");
  if (!contrast) table.fail_missing("contrast", form);
  const std::size_t minus = contrast->find(" - ");
  if (minus == std::string::npos) table.fail("contrast", form);
  primary.condition = trimmed(contrast->substr(0, minus));
  primary.reference = trimmed(contrast->substr(minus + 3));
  for (const std::string& name : {primary.condition, primary.reference}) {
    const std::vector<std::string> known = arm_names(task);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      fail_choice(table, "contrast", name, known);
    }
  }
  if (primary.condition == primary.reference) table.fail("contrast", form);
  const std::string measure = measures_of(task).front();
  primary.measure = choice(table, "measure", {measure}, measure);
  primary.alternative = choice(table, "alternative", {"less", "greater", "two-sided"}, "two-sided");
  study.primary = primary;
}

/// A contrast "mean of the first list minus mean of the second" of shares of a task.
std::vector<std::vector<double>> shares_in(const TomlTable& table, std::string_view key,
                                           const StudyTask& task) {
  const std::string form = "must be two lists of shares [[...], [...]]: the first minus the second";
  const auto lists = table.number_lists(key, scene::kNotNegative);
  if (!lists) table.fail_missing(key, form);
  if (lists->size() != 2) table.fail(key, form);
  for (const std::vector<double>& list : *lists) {
    for (const double share : list) {
      const bool known =
          std::any_of(task.arms.begin(), task.arms.end(), [&](const Arm& arm) { return arm.share == share; });
      if (!known) fail_choice(table, key, shortest(share), arm_names(task));
    }
  }
  return *lists;
}

void read_inverted_u(const TomlTable& table, Study& study) {
  table.allow_only({"task", "rise", "fall", "alpha"});
  const StudyTask& task = task_in(table, study);
  if (!task.signal || task.arms.size() < 3) {
    table.fail("task", "must be a force-detection task with `signal` and three or more shares");
  }
  const auto rise = shares_in(table, "rise", task);
  const auto fall = shares_in(table, "fall", task);
  if (fall[1] != rise[0]) table.fail("fall", "its second list must be the first list of `rise`");
  InvertedUAnalysis analysis{task.name, rise[1], rise[0], fall[0], 0.05};
  const auto largest = [](const auto& list) { return *std::max_element(list.begin(), list.end()); };
  const auto least = [](const auto& list) { return *std::min_element(list.begin(), list.end()); };
  if (largest(analysis.first) >= least(analysis.middle)) {
    table.fail("rise", "the shares of the first list must be above those of the second");
  }
  if (largest(analysis.middle) >= least(analysis.last)) {
    table.fail("fall", "the shares of the first list must be above those of the second");
  }
  constexpr Range kAlphas{0.0, 0.5, true};
  analysis.alpha = table.number("alpha", kAlphas).value_or(analysis.alpha);
  study.inverted_u = analysis;
}

void read_analysis(const TomlTable& root, Study& study) {
  const TomlTable table = table_or_empty(root, "analysis", {"primary", "inverted_u", "own_level", "exclude"});
  if (const auto primary = table.table("primary")) read_primary(*primary, study);
  if (const auto inverted_u = table.table("inverted_u")) read_inverted_u(*inverted_u, study);
  if (const auto own = table.table("own_level")) {
    own->allow_only({"task"});
    const StudyTask& task = task_in(*own, study);
    const bool silent =
        std::any_of(task.arms.begin(), task.arms.end(), [](const Arm& a) { return a.share == 0.0; });
    if (!task.signal || task.arms.size() < 3 || !silent) {
      own->fail("task", "must be a force-detection task with `signal`, the share 0 and two or more others");
    }
    study.own_level = task.name;
  }
  const TomlTable exclude =
      table_or_empty(table, "exclude", {"catch_below", "lost_trials_above", "threshold_at_edge"});
  constexpr Range kFractions{0.0, 1.0};
  study.exclude_catch_below = exclude.number("catch_below", kFractions).value_or(study.exclude_catch_below);
  study.exclude_lost_above =
      exclude.number("lost_trials_above", kFractions).value_or(study.exclude_lost_above);
  study.exclude_threshold_at_edge = exclude.truth("threshold_at_edge").value_or(false);
}

}  // namespace

void fail_choice(const TomlTable& table, std::string_view key, const std::string& value,
                 const std::vector<std::string>& known) {
  const std::string near = nearest_word(value, known);
  table.fail(key, fmt::format("\"{}\" is unknown, must be {}{}", excerpt(value), scene::alternatives(known),
                              near.empty() ? "" : "; did you mean " + near + "?"));
}

std::string choice(const TomlTable& table, std::string_view key, const std::vector<std::string>& known,
                   const std::string& otherwise) {
  const std::optional<std::string> value = table.text(key);
  if (!value) return otherwise;
  if (std::find(known.begin(), known.end(), *value) == known.end()) {
    table.fail(key, "must be " + scene::alternatives(known));
  }
  return *value;
}

int count(const TomlTable& table, std::string_view key, int low, int high, int otherwise) {
  if (!table.has(key)) return otherwise;
  const std::string want = fmt::format("must be a whole number from {} to {}", low, high);
  const std::optional<double> value = table.number(key);
  if (*value < low || *value > high || *value != static_cast<int>(*value)) table.fail(key, want);
  return static_cast<int>(*value);
}

std::string name_in(const TomlTable& table, std::string_view key) {
  const std::string want =
      fmt::format("must be a name of at most {} letters, digits, '.', '-' or '_'", kLongestName);
  const std::optional<std::string> name = table.text(key);
  if (!name) table.fail_missing(key, want);
  const bool valid = std::all_of(name->begin(), name->end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '-' || c == '_';
  });
  if (!valid || name->size() > kLongestName) table.fail(key, want);
  return *name;
}

Study parse_study(const std::string& text, const std::filesystem::path& file) {
  const scene::TomlFile parsed = scene::parse_toml(text, file.string());
  const TomlTable root(parsed);
  root.allow_only({"study", "ethics", "participants", "safety", "screen", "sound", "markers", "response",
                   "homing", "breaks", "condition", "task", "check", "analysis"});
  Study study;
  study.file = file;
  read_study_table(root, study);
  read_people(root, study);
  read_safety(root, study);
  read_screen_and_sound(root, study);
  read_markers(root, study);
  read_response(root, study);
  read_pace(root, study);
  read_conditions(root, study);
  std::vector<ReadTask> tasks;
  for (const TomlTable& table : tables_of(root, "task")) tasks.push_back(read_task(table, study));
  if (tasks.empty()) root.fail_missing("task", "must be one or more tables [[task]]");
  tasks = sort_tasks(std::move(tasks));
  for (const ReadTask& read : tasks) study.tasks.push_back(read.task);
  check_forces(study, tasks);
  read_checks(root, study);
  read_analysis(root, study);
  return study;
}

Study load_study(const std::filesystem::path& file) {
  try {
    return parse_study(InputFile(file, kTomlInput).read_rest(), file);
  } catch (const InputError&) {
    refuse_other_content(file, FileContent::kStudy, "a study file");
    throw;
  }
}

}  // namespace palpate::study
