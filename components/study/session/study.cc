#include "study/session/study.h"

#include <algorithm>
#include <iterator>

#include "core/base/text.h"

namespace palpate::study {

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

std::string sound_text(const Study& study) {
  if (!study.mask_dBA && !study.motors_dBA) return "";
  const auto level = [](const std::optional<double>& of) {
    return of ? shortest(*of) + " dB(A)" : std::string("not measured");
  };
  return "mask " + level(study.mask_dBA) + ", motors " + level(study.motors_dBA) +
         " at the ears, as the lab measured";
}

}  // namespace palpate::study
