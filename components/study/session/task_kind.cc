#include "study/session/task_kind.h"

#include <array>
#include <cmath>

#include "study/session/study.h"

namespace palpate::study {
namespace {

using psychophysics::QuestPlusGrid;

double power_of_ten(double level) { return std::pow(10.0, level); }

constexpr LevelScale kAmplitudes{power_of_ten, "mN", 1e3};

QuestPlusGrid amplitude_grid(const StudyTask& task) {
  return psychophysics::detection_grid(task.least, task.largest, task.steps);
}

QuestPlusGrid comparison_grid(const StudyTask& task) {
  return psychophysics::difference_grid(task.least, task.largest, task.steps);
}

// The levels are equally spaced in log10 of ln(ratio).
QuestPlusGrid ratio_grid(const StudyTask& task) {
  const double low = std::log10(std::log(task.least));
  const double high = std::log10(std::log(task.largest));
  return psychophysics::detection_grid(std::pow(10.0, low), std::pow(10.0, high),
                                       static_cast<int>(std::lround((task.steps - 1) / (high - low))));
}

// In the order of TaskKind.
const std::array<TaskDescription, kTaskKinds>& task_kinds() {
  static const std::array<TaskDescription, kTaskKinds> kinds{{
      {.name = "noise-threshold",
       .sentence = "Press gently and hold. In which interval did it tingle?",
       .instructions = "You will feel two intervals, one after the other, and two boxes light up with them. "
                       "In one of them the tool tingles, often very weakly. Press gently until the bar is in "
                       "the band, keep that force through both intervals, and then choose the interval that "
                       "tingled. If you are not sure, guess: there is always one.",
       .stimulus = Stimulus::kNoise,
       .scale = kAmplitudes,
       .axis = "standard deviation of the noise [mN]",
       .grid = amplitude_grid},
      {.name = "force-detection",
       .sentence = "Press gently and hold. In which interval was there an extra force?",
       .instructions = "You will feel two intervals, one after the other. In one of them a weak extra force "
                       "pushes against your hand. Press gently until the bar is in the band, keep that force "
                       "through both intervals, and then choose the interval with the extra force. If you "
                       "are not sure, guess: there is always one.",
       .stimulus = Stimulus::kForce,
       .scale = kAmplitudes,
       .axis = "force [mN]",
       .grid = amplitude_grid},
      {.name = "stiffness",
       .sentence = "Press once in each interval, until \"come up\". Which was stiffer?",
       .instructions =
           "You will press twice, once in each interval. Press down at your own pace until the screen says "
           "\"come up\", then leave the tissue. One of the two is stiffer: choose it. Judge by how hard the "
           "tissue feels. If you are not sure, guess: they always differ.",
       .action = "Press",
       .stimulus = Stimulus::kTissue,
       .hand = HandAction::kPress,
       .comparison = true,
       .measures = {"ln_jnd"},
       .scale = {[](double level) { return std::exp(level); }},
       .axis = "stiffness of the comparison divided by that of the standard",
       .marks = "0.5, 1, 2",
       .grid = comparison_grid,
       .tissue = [](const StudyTask& task,
                    double ratio) { return TissueChange{.k1 = task.standard_k1 * ratio}; }},
      {.name = "inclusion",
       .sentence = "Search in each interval; Space ends a search. Which had the lump?",
       .instructions =
           "Move the tool over the organ in each interval and look for a hard lump under the surface. Space "
           "ends a search. One of the two intervals has a lump: choose it. If you are not sure, guess.",
       .action = "Search. Space: done",
       .stimulus = Stimulus::kTissue,
       .hand = HandAction::kSearch,
       .scale = {[](double level) { return std::exp(power_of_ten(level)); }},
       .axis = "stiffness of the inclusion divided by that of the tissue around it",
       .marks = "1.2, 2, 4, 8",
       .grid = ratio_grid,
       .tissue = [](const StudyTask& /*task*/, double ratio) { return TissueChange{.inclusion = ratio}; }},
      {.name = "force-control",
       .sentence = "Press until the bar is in the band. Keep that force when the bar goes.",
       .instructions = "Press until the bar is in the band and remember how that feels. Then the bar goes: "
                       "keep the same force for six seconds.",
       .action = "Hold this force",
       .stimulus = Stimulus::kTarget,
       .measures = {"ln_rms", "ln_variation"},
       .scale = {[](double level) { return level; }, "N"},
       .axis = "target [N]",
       .grid = amplitude_grid},
  }};
  return kinds;
}

}  // namespace

bool TissueChange::apply_to(model::TissueNumbers& tissue) const noexcept {
  tissue.k1 = k1.value_or(tissue.k1);
  return k1.has_value();
}

const TaskDescription& describe(TaskKind kind) noexcept {
  return task_kinds()[static_cast<std::size_t>(kind)];
}

std::vector<std::string> task_kind_names() {
  std::vector<std::string> names;
  for (const TaskDescription& kind : task_kinds()) names.emplace_back(kind.name);
  return names;
}

}  // namespace palpate::study
