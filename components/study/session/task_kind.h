#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "palpate/tissue.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::study {

struct StudyTask;

enum class TaskKind {
  kNoiseThreshold,  // which interval had the noise?
  kForceDetection,  // which interval had the extra force?
  kStiffness,       // which interval was stiffer?
  kInclusion,       // which interval had the inclusion?
  kForceControl     // hold a force
};
inline constexpr std::size_t kTaskKinds = 5;

/// What the level of a trial is a level of.
enum class Stimulus {
  kNoise,   // standard deviation of the noise, which one interval has
  kForce,   // commanded force of one interval
  kTissue,  // stiffness of the tissue of one interval, as a ratio
  kTarget   // force to hold: one interval without an answer
};

/// What the hand does in an interval.
enum class HandAction {
  kHold,   // keeps the force in the band or at the target, or waits outside
  kPress,  // presses once and leaves the tissue
  kSearch  // moves over the organ
};

/// The tissue of an interval, as far as the task changes it.
struct TissueChange {
  std::optional<double> k1{};         // N/m
  std::optional<double> inclusion{};  // its stiffness divided by that of the tissue around it

  /// [any] Changes the numbers of a tissue. @return whether it states any
  bool apply_to(model::TissueNumbers& tissue) const noexcept;
};

/// What a level means.
struct LevelScale {
  double (*value)(double level);  // N, or a ratio
  const char* unit = "ratio";
  double factor = 1.0;  // from the value to the unit
};

/// What the program knows of a kind of task, apart from its keys in a study file (task_reader.cc).
struct TaskDescription {
  const char* name;                        // in a study file
  const char* sentence;                    // the task, for the participant
  const char* instructions;                // before the first trial, for the participant
  const char* action = "Keep this force";  // what to do while an interval lasts
  Stimulus stimulus;
  HandAction hand = HandAction::kHold;
  bool comparison = false;  // the answer is "comparison is stiffer"; else it is right or wrong
  // What the analysis compares; a primary analysis is of the first.
  std::vector<std::string> measures{"ln_threshold"};
  LevelScale scale;
  const char* axis;        // title of a figure's axis of stimuli
  const char* marks = "";  // of this axis; empty: gnuplot's own
  psychophysics::QuestPlusGrid (*grid)(const StudyTask& task);
  TissueChange (*tissue)(const StudyTask& task, double ratio) = nullptr;  // of kTissue
};

/// [any]
[[nodiscard]] const TaskDescription& describe(TaskKind kind) noexcept;
/// [any] The names of all kinds, in their order.
[[nodiscard]] std::vector<std::string> task_kind_names();

}  // namespace palpate::study
