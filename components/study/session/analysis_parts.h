#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/session/analysis.h"

// The parts of analyse().
namespace palpate::study {

/// Trials of a task that count, in their order.
using Trials = std::vector<const TrialRecord*>;

/// [setup] Stimuli and parameters of a task, with those levels of the trials that are not in grid_of().
[[nodiscard]] psychophysics::QuestPlusGrid grid_with_levels(const StudyTask& task,
                                                            std::span<const Participant> people);

/// [any] Whether a psychometric function of the level is fitted: not to one fixed signal, nor to force
/// control.
[[nodiscard]] bool has_function(const StudyTask& task) noexcept;

/// [setup] A fit from scratch. @param quest of the task's grid; is reset
[[nodiscard]] std::optional<ThresholdFit> fit_trials(psychophysics::QuestPlus& quest, const StudyTask& task,
                                                     const Trials& trials);

/// [setup] One person's results; flags and exclusions too. @param quests one for each task with a function
[[nodiscard]] PersonResult analyse_person(const Study& study, const Participant& person,
                                          const ArmNames& names,
                                          std::vector<std::optional<psychophysics::QuestPlus>>& quests);

/// [setup] Correlations of the answers to a comparison with differences of force, depth and work.
[[nodiscard]] std::vector<CueWeight> cue_weights(const Trials& trials);

/// [setup] Change of the correct answers over a task, given what is expected of each trial.
[[nodiscard]] std::optional<Trend> trend_of(const StudyTask& task, const Trials& trials,
                                            const std::vector<double>& expected);

/// [setup] Fills in flags and exclusions.
void flag_person(const Study& study, const Participant& person, const std::vector<TaskResult>& names,
                 PersonResult& result);

/// [any] p value of an alternative: half of the two-sided one when the effect has its sign.
[[nodiscard]] double p_of_alternative(double two_sided, double effect,
                                      const std::string& alternative) noexcept;

/// [setup] Contrasts, curves and changes of the group, from its people.
void analyse_group(const Study& study, const std::vector<std::optional<psychophysics::QuestPlus>>& quests,
                   StudyAnalysis& analysis);

/// [setup] d' of a person at the own level less that without noise, see StudyAnalysis::own_level. Empty with
/// fewer than 20 trials at a level.
[[nodiscard]] std::optional<double> own_level_gain(const StudyTask& task, const std::vector<Trials>& arms);

/// [setup] Guesses about the noise.
[[nodiscard]] std::vector<Guesses> count_guesses(const Study& study, std::span<const Participant> people,
                                                 const ArmNames& names);

}  // namespace palpate::study
