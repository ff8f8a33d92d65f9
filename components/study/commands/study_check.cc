// `palpate study check`: reads a study file and prints its plan, its largest forces and what is missing.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/contact/contact.h"
#include "io/scene/device_kinds.h"
#include "io/system/file_exists.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "study/commands/study_commands.h"
#include "study/screens/study_keys.h"
#include "study/session/study.h"

namespace palpate::app {
namespace {

using study::ForceBound;
using study::HandAction;
using study::PlannedSession;
using study::Study;
using study::StudyTask;

constexpr double kSecondsPerMinute = 60.0;
constexpr double kRounding = 1e-9;  // N

struct CheckedTask {
  const StudyTask* task = nullptr;
  int trials = 0;        // with practice, without repetition
  double minutes = 0.0;  // without breaks
  ForceBound force;
};

struct CheckedStudy {
  Study study;
  scene::Scene scene;
  std::vector<CheckedTask> tasks;
  std::vector<PlannedSession> sessions;
  std::vector<std::string> missing;  // without it the study cannot be prepared
  std::vector<std::string> hints;
};

/// Force [N] of the stiffest tissue at the depth of the press.
double press_force(const StudyTask& task, const scene::Scene& scene) {
  model::TissueParameters tissue = scene.tissue;
  tissue.k1 = task.standard_k1 * task.largest;
  tissue = model::for_tool(tissue, contact::tip_radius_of(scene.tools.front()));
  return model::SpringLaw(tissue, model::Direction::kPress, 1.0 / scene.rate_Hz).force_at(task.depth).force;
}

void check_task(const StudyTask& task, CheckedStudy& made) {
  CheckedTask& checked = made.tasks.emplace_back();
  checked.task = &task;
  checked.trials = task.least_practice() + task.trials * static_cast<int>(task.arms.size());
  checked.minutes = checked.trials * study::trial_seconds(made.study, task) / kSecondsPerMinute;
  checked.force = study::force_bound(made.study, task);
  const bool pressed = task.hand() == HandAction::kPress && task.depth > 0.0;
  if (pressed) checked.force.tissue = press_force(task, made.scene);
  if (checked.force.sum() > made.scene.safety.max_force + kRounding) {
    made.missing.push_back(fmt::format(
        "task {}: its largest force is {} N, must be at most {} N, safety.max_force_N of scene and study{}",
        task.name, brief(checked.force.sum()), shortest(made.scene.safety.max_force),
        pressed ? ": lower depth_mm, ratio or standard_k1_N_per_m" : ""));
  }
  if (task.practice_until && task.practice_until->most > task.least_practice()) {
    const int more = task.practice_until->most - task.least_practice();
    made.hints.push_back(fmt::format(
        "task {}: practice until {} of {} are correct may take {} trials, {} min, more than planned",
        task.name, task.practice_until->correct, task.practice_until->of, more,
        brief(more * study::trial_seconds(made.study, task) / kSecondsPerMinute, 2)));
  }
  const double hold = task.two_intervals() ? 0.0 : 8.0;  // s, with reaching
  const double longest = task.hand() == HandAction::kSearch ? task.search_time : hold;
  if (task.has_noise() && longest > made.study.max_continuous_noise) {
    made.hints.push_back(fmt::format("task {}: the noise is faded out for {} s after every {} s", task.name,
                                     shortest(study::kNoisePause),
                                     shortest(made.study.max_continuous_noise)));
  }
}

void check_surroundings(const std::string& file, CheckedStudy& made) {
  const Study& study = made.study;
  const std::filesystem::path consent = study.file.parent_path() / study.consent_file;
  if (study.consent_file.empty() && !study.language.consent.empty()) {
    // The language's file has the text.
  } else if (study.consent_file.empty()) {
    made.hints.emplace_back("no [ethics] consent_file: only simulated people can take part");
  } else if (!regular_file_exists(consent)) {
    made.missing.push_back("ethics.consent_file: there is no file " + consent.string());
  }
  if (study.approval.empty()) {
    made.hints.emplace_back(
        "no [ethics] approval of an ethics committee: only simulated people can take part");
  }
  const scene::DeviceKind* device = scene::find_device_kind(made.scene.devices.front().kind);
  if (device != nullptr && (!device->held || device->name == "emulated")) {
    made.hints.push_back(fmt::format(
        "the scene's device is {}, which no hand holds: give `palpate study run` a --device", device->name));
  }
  if (made.scene.devices.size() > 1) made.missing.emplace_back("the scene must have one tool");
  const bool noise = std::any_of(study.tasks.begin(), study.tasks.end(),
                                 [](const StudyTask& task) { return task.has_noise(); });
  for (const StudyTask& task : study.tasks) {
    if (task.two_intervals() && task.catch_share == 0.0) {
      made.hints.push_back("task " + task.name + " has no catch trials: lapses are only modelled");
    }
    if (task.two_intervals() && task.practice == 0 && !task.practice_until) {
      made.hints.push_back("task " + task.name + " has no practice: people learn while they are measured");
    }
  }
  if (noise && !study.calibration) {
    made.hints.emplace_back("no [study] calibration: nobody knows how much of the noise reaches the grip");
  }
  if (noise && !study.check_audible) {
    made.hints.emplace_back("no [[check]] kind = \"audible\": nobody tests whether the noise is heard");
  }
  if (noise && !study.check_blinding) {
    made.hints.emplace_back("no [[check]] kind = \"blinding\": nobody tests whether people guess the noise");
  }
  if (!study.primary) made.hints.emplace_back("no [analysis] primary: all results are exploratory");
  constexpr double kLouder = 10.0;   // dB: then the sum is 0.4 dB above the mask alone
  constexpr double kLongest = 85.0;  // dB(A): EU directive 2003/10/EC, of a whole working day
  if (noise && study.sound_mask != "none" && !(study.mask_dBA && study.motors_dBA)) {
    made.hints.emplace_back(
        "no [sound] mask_dBA and motors_dBA: nobody has measured how loud mask and motors are at the ears");
  } else if (study.mask_dBA && study.motors_dBA && *study.mask_dBA < *study.motors_dBA + kLouder) {
    made.hints.push_back(fmt::format("sound: the mask is {} dB louder than the motors, better {} or more",
                                     brief(*study.mask_dBA - *study.motors_dBA, 3), shortest(kLouder)));
  }
  if (study.mask_dBA && *study.mask_dBA > kLongest) {
    made.hints.push_back(fmt::format("sound: the mask is above {} dB(A)", shortest(kLongest)));
  }
  if (study.sound_mask == "none") made.hints.emplace_back("no [sound] mask: motors can be heard");
  made.hints.push_back("palpate study power " + file +
                       ": power and interval by simulation, before anybody is invited");
}

CheckedStudy check(const std::string& file) {
  CheckedStudy made;
  made.study = study::load_study(file);
  check_keys(made.study);
  for (std::uint32_t i = 1; i < study::task_orders(made.study).size(); ++i) {
    static_cast<void>(study::plan_sessions(made.study, i));
  }
  made.sessions = study::plan_sessions(made.study);
  made.scene = scene::load(study::scene_of(made.study));
  for (const StudyTask& task : made.study.tasks) check_task(task, made);
  check_surroundings(file, made);
  return made;
}

const CheckedTask& strongest(const CheckedStudy& made) {
  return *std::max_element(made.tasks.begin(), made.tasks.end(),
                           [](const auto& a, const auto& b) { return a.force.sum() < b.force.sum(); });
}

double minutes_of(const CheckedStudy& made) {
  double sum = 0.0;
  for (const PlannedSession& session : made.sessions) sum += session.minutes;
  return sum;
}

std::string part_text(const Study& study, const study::PlannedPart& part) {
  const std::string& name = study.tasks[part.task].name;
  if (part.run != study::kFirstRun) return fmt::format("{} again {}", name, part.trials);
  return fmt::format("{} {}-{}", name, part.first_trial + 1, part.first_trial + part.trials);
}

void print_text(const CheckedStudy& made) {
  const Study& study = made.study;
  std::cout << fmt::format("study {}, scene {}, {} and {} min a person\n\n", study.name, study.scene,
                           counted(made.sessions.size(), "session", "sessions"),
                           std::lround(minutes_of(made)));
  if (study.calibration) {
    std::cout << fmt::format("calibration {}: {}; the largest noise, {} N (sd), is {} {}\n\n",
                             study.calibration_file, study::describe(*study.calibration),
                             shortest(study.max_noise), brief(study.calibration->at_grip(study.max_noise), 3),
                             study.calibration->unit);
  }
  if (const std::string sound = study::sound_text(study); !sound.empty()) std::cout << sound << "\n\n";
  if (!study.markers.empty()) std::cout << "markers to " << joined(study.markers) << "\n\n";
  std::cout << fmt::format("{:<16}{:<17}{:>5}{:>8}{:>10}{:>8}  {}\n", "task", "kind", "arms", "trials",
                           "practice", "min", "tissue + commanded + noise [N]");
  for (const CheckedTask& checked : made.tasks) {
    const StudyTask& task = *checked.task;
    const std::string practice = task.practice_until
                                     ? fmt::format("{}-{}", task.least_practice(), task.practice_until->most)
                                     : std::to_string(task.practice);
    std::cout << fmt::format(
        "{:<16}{:<17}{:>5}{:>8}{:>10}{:>8.1f}  {} + {} + {}\n", task.name, describe(task.kind).name,
        task.arms.size(), checked.trials - task.least_practice(), practice, checked.minutes,
        brief(checked.force.tissue, 3), brief(checked.force.commanded, 3), brief(checked.force.noise, 3));
  }
  std::cout << '\n';
  for (std::size_t i = 0; i < made.sessions.size(); ++i) {
    std::vector<std::string> parts;
    for (const study::PlannedPart& part : made.sessions[i].parts) parts.push_back(part_text(study, part));
    std::cout << fmt::format("session {}  {:>5.1f} min  {}\n", i + 1, made.sessions[i].minutes,
                             joined(parts));
  }
  if (const std::size_t orders = study::task_orders(study).size(); orders > 1) {
    std::cout << fmt::format(
        "task order: {} of a Williams square, in turn; the sessions above are those of the first\n",
        counted(orders, "row", "rows"));
  }
  const CheckedTask& most = strongest(made);
  std::cout << fmt::format("\nlargest force {} N, of task {}; limit {} N{}\n", brief(most.force.sum(), 3),
                           most.task->name, shortest(made.scene.safety.max_force),
                           made.scene.safety.max_force < study.max_force ? " of the scene" : " of the study");
  for (const std::string& text : made.missing) std::cout << "missing: " << text << '\n';
  for (const std::string& text : made.hints) std::cout << "hint: " << text << '\n';
}

nlohmann::ordered_json json_of(const CheckedTask& checked) {
  nlohmann::ordered_json json;
  json["name"] = checked.task->name;
  json["kind"] = describe(checked.task->kind).name;
  json["arms"] = checked.task->arms.size();
  json["trials"] = checked.trials - checked.task->least_practice();
  json["practice"] = checked.task->least_practice();
  json["minutes"] = checked.minutes;
  json["tissue_N"] = checked.force.tissue;
  json["commanded_N"] = checked.force.commanded;
  json["noise_N"] = checked.force.noise;
  return json;
}

void print_json(const CheckedStudy& made) {
  nlohmann::ordered_json json;
  json["study"] = made.study.name;
  json["scene"] = made.study.scene;
  json["minutes"] = minutes_of(made);
  if (const auto& calibration = made.study.calibration) {
    json["calibration"] = {{"file", made.study.calibration_file},
                           {"sha256", calibration->sha256},
                           {"gain_per_N", calibration->gain},
                           {"unit", calibration->unit},
                           {"max_noise_at_grip", calibration->at_grip(made.study.max_noise)}};
  }
  if (made.study.mask_dBA) json["mask_dBA"] = *made.study.mask_dBA;
  if (made.study.motors_dBA) json["motors_dBA"] = *made.study.motors_dBA;
  if (!made.study.markers.empty()) json["markers"] = made.study.markers;
  json["tasks"] = nlohmann::ordered_json::array();
  for (const CheckedTask& checked : made.tasks) json["tasks"].push_back(json_of(checked));
  json["sessions"] = nlohmann::ordered_json::array();
  for (const PlannedSession& session : made.sessions) {
    nlohmann::ordered_json& added = json["sessions"].emplace_back();
    added["minutes"] = session.minutes;
    for (const study::PlannedPart& part : session.parts) {
      added["parts"].push_back({{"task", made.study.tasks[part.task].name},
                                {"repeat", part.run != study::kFirstRun},
                                {"first_trial", part.first_trial + 1},
                                {"trials", part.trials}});
    }
  }
  json["largest_force_N"] = strongest(made).force.sum();
  json["largest_force_task"] = strongest(made).task->name;
  json["max_force_N"] = made.scene.safety.max_force;
  json["missing"] = made.missing;
  json["hints"] = made.hints;
  std::cout << json.dump(2) << '\n';
}

}  // namespace

void add_study_check(CLI::App& study, int& exit_code) {
  struct Flags {
    std::string file;
    bool json = false;
  };
  auto flags = std::make_shared<Flags>();
  CLI::App* command =
      study.add_subcommand("check", "Read a study file; print trials, minutes, forces and what is missing");
  command->add_option("study", flags->file, "The study file (.toml)")->required();
  command->add_flag("--json", flags->json, "print one JSON document");
  command->footer(
      "Examples:\n  palpate study check examples/study/touch-noise.toml\n  palpate study check touch.toml "
      "--json\n"
      "Minutes include breaks, set-up and homing, but no repeated trials. Exit: 0 complete, 2 bad or missing "
      "input");
  command->callback([flags, &exit_code] {
    const CheckedStudy made = check(flags->file);
    if (flags->json) {
      print_json(made);
    } else {
      print_text(made);
    }
    exit_code = made.missing.empty() ? kDone : kBadInput;
  });
}

}  // namespace palpate::app
