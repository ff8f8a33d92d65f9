#include "study/session/study.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace palpate::study {

const char* to_string(TaskKind kind) noexcept {
  switch (kind) {
    case TaskKind::kForceDetection:
      return "force-detection";
    case TaskKind::kStiffness:
      return "stiffness";
    case TaskKind::kInclusion:
      return "inclusion";
    case TaskKind::kForceControl:
      return "force-control";
    case TaskKind::kNoiseThreshold:
      break;
  }
  return "noise-threshold";
}

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

psychophysics::QuestPlusGrid grid_of(const StudyTask& task) {
  if (task.comparison()) return psychophysics::difference_grid(task.least, task.largest, task.steps);
  if (task.kind != TaskKind::kInclusion) {
    return psychophysics::detection_grid(task.least, task.largest, task.steps);
  }
  // Detection of an inclusion: the levels are equally spaced in log10 of ln(ratio).
  const double low = std::log10(std::log(task.least));
  const double high = std::log10(std::log(task.largest));
  return psychophysics::detection_grid(std::pow(10.0, low), std::pow(10.0, high),
                                       static_cast<int>(std::lround((task.steps - 1) / (high - low))));
}

ForceBound force_bound(const Study& study, const StudyTask& task) {
  constexpr double kDeviations = 6.0;  // the noise exceeds them once in 10^9 samples
  ForceBound bound;
  if (task.has_noise()) bound.noise = kDeviations * study.max_noise;
  switch (task.kind) {
    case TaskKind::kNoiseThreshold:
      bound.tissue = task.free ? 0.0 : task.band_high;
      bound.noise = kDeviations * task.largest;
      break;
    case TaskKind::kForceDetection:
      bound.tissue = task.free ? 0.0 : task.band_high;
      bound.commanded = task.largest;
      if (task.signal) {
        const std::optional<std::size_t> source = study.find_task(task.signal->task);
        bound.commanded = source ? study.tasks[*source].largest : 0.0;
      }
      break;
    case TaskKind::kForceControl:
      bound.tissue = *std::max_element(task.targets.begin(), task.targets.end());
      break;
    case TaskKind::kStiffness:
    case TaskKind::kInclusion:
      break;
  }
  return bound;
}

std::string sentence_of(const StudyTask& task) {
  switch (task.kind) {
    case TaskKind::kNoiseThreshold:
      return "Press gently and hold. In which interval did it tingle?";
    case TaskKind::kForceDetection:
      return "Press gently and hold. In which interval was there an extra force?";
    case TaskKind::kStiffness:
      return "Press once in each interval, until \"come up\". Which was stiffer?";
    case TaskKind::kInclusion:
      return "Search in each interval; Space ends a search. Which had the lump?";
    case TaskKind::kForceControl:
      return "Press until the bar is in the band. Keep that force when the bar goes.";
  }
  return "";
}

}  // namespace palpate::study
