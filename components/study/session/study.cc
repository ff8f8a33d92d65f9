#include "study/session/study.h"

#include <iterator>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/names.h"
#include "io/scene/scene_file.h"
#include "io/system/file_exists.h"
#include "palpate/builtin.h"
#include "palpate/error.h"

namespace palpate::study {
namespace {

/// The scene of a run without a scene file, in which settings are allowed.
scene::SceneText text_of_organ(const std::string& organ) {
  return {fmt::format("[scene]\nname = \"{0}\"\n[organ]\nmesh = \"{0}\"\n[tool]\nmesh = \"curved-forceps\"\n",
                      organ),
          {}};
}

}  // namespace

bool StudyTask::has_noise() const noexcept {
  return std::any_of(arms.begin(), arms.end(), [](const Arm& arm) { return arm.share > 0.0; });
}

std::optional<std::size_t> Study::find_task(const std::string& wanted) const {
  const auto found =
      std::find_if(tasks.begin(), tasks.end(), [&](const StudyTask& task) { return task.name == wanted; });
  if (found == tasks.end()) return std::nullopt;
  return static_cast<std::size_t>(std::distance(tasks.begin(), found));
}

std::optional<std::size_t> Study::threshold_task() const {
  const auto found =
      std::find_if(tasks.begin(), tasks.end(), [](const StudyTask& task) { return task.sets_threshold; });
  if (found == tasks.end()) return std::nullopt;
  return static_cast<std::size_t>(std::distance(tasks.begin(), found));
}

psychophysics::QuestPlusGrid grid_of(const StudyTask& task) { return describe(task.kind).grid(task); }

IntervalStimulus stimulus_of(const StudyTask& task, double level, bool with_signal) {
  const TaskDescription& kind = describe(task.kind);
  IntervalStimulus stimulus;
  stimulus.noise = task.stimulus() != Stimulus::kNoise || with_signal;
  if (task.stimulus() == Stimulus::kForce && with_signal) stimulus.force = kind.scale.value(level);
  if (task.stimulus() == Stimulus::kTissue) {
    stimulus.tissue = kind.tissue(task, with_signal ? kind.scale.value(level) : 1.0);
  }
  return stimulus;
}

std::vector<std::string> measures_of(const StudyTask& task) {
  return task.signal ? std::vector<std::string>{"d_prime"} : describe(task.kind).measures;
}

ForceBound force_bound(const Study& study, const StudyTask& task) {
  constexpr double kDeviations = 6.0;  // the noise exceeds them once in 10^9 samples
  ForceBound bound;
  if (task.has_noise()) bound.noise = kDeviations * study.max_noise;
  if (!task.two_intervals()) {
    bound.tissue = *std::max_element(task.targets.begin(), task.targets.end());
  } else if (!task.leaves_tissue() && !task.free) {
    bound.tissue = task.band_high;
  }
  if (task.stimulus() == Stimulus::kNoise) bound.noise = kDeviations * task.largest;
  if (task.stimulus() == Stimulus::kForce) {
    bound.commanded = task.largest;
    if (task.signal) {
      const std::optional<std::size_t> source = study.find_task(task.signal->task);
      bound.commanded = source ? study.tasks[*source].largest : 0.0;
    }
  }
  return bound;
}

scene::Overrides scene_of(const Study& study) {
  scene::Overrides request;
  const std::filesystem::path file = study.file.parent_path() / study.scene;
  double limit = scene::SafetySetup{}.max_force;
  if (regular_file_exists(file)) {
    request.scene = file;
    limit = scene::read_scene_file(file).safety.max_force;
  } else {
    const std::vector<std::string>& known = geometry::builtin_organ_names();
    if (std::find(known.begin(), known.end(), study.scene) == known.end()) {
      const std::string near = nearest_word(study.scene, known);
      throw InputError(
          fmt::format("{}: study.scene = \"{}\": must be a scene file, relative to the study file, or {}{}",
                      study.file.string(), study.scene, scene::alternatives(known),
                      near.empty() ? "" : "; did you mean " + near + "?"));
    }
    request.organ = study.scene;
    request.scene_text = text_of_organ(study.scene);
  }
  if (study.max_force < limit) request.settings.push_back({"safety.max_force_N", shortest(study.max_force)});
  return request;
}

std::vector<std::string> exclusion_rules(const Study& study) {
  std::vector<std::string> rules = {
      fmt::format("fewer than {} of the catch trials correct", percent(study.exclude_catch_below, 0)),
      fmt::format("more than {} of the trials spoiled", percent(study.exclude_lost_above, 0))};
  if (study.exclude_threshold_at_edge) rules.emplace_back("a noise threshold at the edge of the stimuli");
  return rules;
}

std::string sound_text(const Study& study) {
  if (!study.mask_dBA && !study.motors_dBA) return "";
  const auto level = [](const std::optional<double>& of) {
    return of ? shortest(*of) + " dB(A)" : std::string("not measured");
  };
  return "mask " + level(study.mask_dBA) + ", motors " + level(study.motors_dBA) +
         " at the ears, as the lab measured";
}

}  // namespace palpate::study
