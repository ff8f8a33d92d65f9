#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/scene.h"

#include "study/psychophysics/psychophysics.h"
#include "study/session/calibration.h"
#include "study/session/language.h"
#include "study/session/task_kind.h"

namespace palpate::study {

enum class Method { kQuestPlus, kStaircase, kConstant };

enum class NoiseProfile {
  kConstant,  // the same standard deviation at any distance
  kProximity  // K/(d + d0)
};

/// One treatment that trials are compared under. Standard deviation in contact: share x own noise threshold.
struct Arm {
  std::string name;
  double share = 0.0;
  NoiseProfile profile = NoiseProfile::kConstant;
  double d0 = 5e-3;  // m, of kProximity
};

/// When the practice before a task ends: at the first trial after which `correct` of the last `of` were
/// correct, or after `most` trials.
struct PracticeCriterion {
  int correct = 8;
  int of = 10;
  int most = 40;
};

/// Force of a detection task, taken from an earlier task's psychometric function.
struct SignalFrom {
  std::string task;
  double correct = 0.65;  // share of correct answers without noise
};

/// One task of a study. SI units: N, m, N/m, s.
struct StudyTask {
  std::string name;
  TaskKind kind = TaskKind::kNoiseThreshold;
  Method method = Method::kQuestPlus;
  std::vector<Arm> arms;  // at least one; a task without conditions has one without noise, named ""
  int trials = 60;        // for each arm, without practice; of kForceControl: targets x repeats
  int practice = 0;       // trials before the first, at an easy level, in arms drawn at random
  int examples = 0;       // first practice trials, before which the answer is shown
  std::optional<PracticeCriterion> practice_until;  // practice goes on until it is met
  double catch_share = 0.0;                         // share of trials at the largest level, within `trials`
  bool sets_threshold = false;  // its estimate is the noise threshold that shares refer to
  bool repeat_at_end = false;   // run again at the end of its session
  bool each_session = false;    // run again at the start of each later session, whose noise it sets

  bool free = false;       // the tool need not press
  double band_low = 0.5;   // N, tissue force in which an interval counts
  double band_high = 1.5;  // N
  double interval = 0.8;   // s
  double gap = 0.5;        // s

  // Stimuli of kNoiseThreshold (standard deviation) and kForceDetection: amplitudes [N]; kStiffness and
  // kInclusion: ratios.
  double least = 0.0;
  double largest = 0.0;
  int steps = 0;                     // stimuli for each factor of ten (amplitudes), or their number (ratios)
  std::optional<SignalFrom> signal;  // kForceDetection: one level instead of a range

  double standard_k1 = 18.0;    // N/m, kStiffness
  double depth = 0.0;           // m: of the press (kStiffness; 0: free), of the inclusion (kInclusion)
  double radius = 5e-3;         // m, of the inclusion
  double search_time = 15.0;    // s, of an interval of kInclusion
  std::vector<double> targets;  // N, kForceControl
  int repeats = 0;              // kForceControl: trials for each target and arm

  /// [any] Some arm has noise.
  [[nodiscard]] bool has_noise() const noexcept;
  /// [any] Practice trials that are planned for; a criterion may need more.
  [[nodiscard]] int least_practice() const noexcept {
    return practice_until ? std::max(practice, practice_until->of) : practice;
  }
  /// [any]
  [[nodiscard]] Stimulus stimulus() const noexcept { return describe(kind).stimulus; }
  [[nodiscard]] HandAction hand() const noexcept { return describe(kind).hand; }
  /// [any] Answers are two-interval choices; else a target is held.
  [[nodiscard]] bool two_intervals() const noexcept { return stimulus() != Stimulus::kTarget; }
  /// [any] The tool leaves the tissue between the intervals.
  [[nodiscard]] bool leaves_tissue() const noexcept { return hand() != HandAction::kHold; }
  /// [any] Levels are signed logarithms of ratios; else log10 of amplitudes [N] or of ln ratio, or targets
  /// [N].
  [[nodiscard]] bool comparison() const noexcept { return describe(kind).comparison; }
};

/// What one interval of a task renders.
struct IntervalStimulus {
  bool noise = true;   // the trial's noise is on
  double force = 0.0;  // N, commanded
  TissueChange tissue;
};

/// [any] @param with_signal whether the interval has the signal, or the comparison @param level of the signal
[[nodiscard]] IntervalStimulus stimulus_of(const StudyTask& task, double level, bool with_signal);

/// [any] The measures that the analysis compares; a primary analysis is of the first. One fixed force is
/// compared by d'.
[[nodiscard]] std::vector<std::string> measures_of(const StudyTask& task);

/// [setup] Stimuli and parameter grid of a task with two intervals. Level: log10 of an amplitude [N]
/// (kNoiseThreshold, kForceDetection), ln(comparison/standard) (kStiffness), log10(ln ratio) (kInclusion).
[[nodiscard]] psychophysics::QuestPlusGrid grid_of(const StudyTask& task);

/// The primary analysis, fixed before the first participant.
struct PrimaryAnalysis {
  std::string task;
  std::string condition, reference;       // the contrast "condition - reference"
  std::string measure = "ln_jnd";         // ln_jnd | d_prime | ln_rms | ln_threshold
  std::string alternative = "two-sided";  // less | greater | two-sided
};

struct InvertedUAnalysis {
  std::string task;
  std::vector<double> first, middle, last;  // shares: rise = middle - first, fall = last - middle
  double alpha = 0.05;
};

/// A study file (docs/study.md), checked. SI units.
struct Study {
  std::filesystem::path file;
  std::string name;
  std::string scene;  // built-in name or path as written
  std::uint64_t seed = 1;
  int sessions = 1;
  double max_minutes = 60.0;
  bool latin_order = false;  // tasks that nothing depends on, in the order of a Williams square

  std::string calibration_file;            // beside the study file; empty: none
  std::optional<Calibration> calibration;  // what the grip gets

  std::string consent_file;  // as written; empty: none
  std::string approval;
  std::string withdraw_key;

  bool random_ids = true;  // P and 4 letters or digits; else P01, P02, ...
  std::vector<std::string> ask;

  double max_force = 6.0;             // N
  double max_noise = 0.1;             // N, standard deviation
  double max_continuous_noise = 3.0;  // s

  std::string language_file;  // beside the study file; empty: a built-in language
  Language language;          // of the participant's screens
  std::string experimenter_screen = "second-display";
  std::string sound_mask = "pink";  // pink | white | none
  double sound_level_dB = -20.0;
  // Measured by the lab at the participant's ears, under the headphones [dB(A)]
  std::optional<double> mask_dBA, motors_dBA;

  std::vector<std::string> markers;  // to other instruments, see parse_marker_target()

  std::vector<std::string> first_keys, second_keys;
  std::uint32_t next_button = 0;
  double timeout = 8.0;               // s
  std::string feedback = "practice";  // never | practice | always

  double homing_radius = 10e-3;  // m
  double homing_still = 0.5;     // s
  int break_trials = 30;
  double break_minutes = 8.0;
  double break_least = 30.0;  // s

  std::vector<Arm> conditions;
  std::vector<StudyTask> tasks;  // in the order in which they run: a task after the one it takes a value from
  bool check_audible = false;
  bool check_blinding = false;

  std::optional<PrimaryAnalysis> primary;
  std::optional<InvertedUAnalysis> inverted_u;
  std::string
      own_level;  // task of one force and several shares: each person's own level is tested; empty: none
  double exclude_catch_below = 0.7;
  double exclude_lost_above = 0.1;
  bool exclude_threshold_at_edge =
      false;  // people whose noise was set by a threshold at the end of the range

  /// [any] Index of a task by name; empty for an unknown name.
  [[nodiscard]] std::optional<std::size_t> find_task(const std::string& name) const;
  /// [any] Index of the task that sets the noise threshold; empty: no task does.
  [[nodiscard]] std::optional<std::size_t> threshold_task() const;
};

/// [setup] Whom [analysis] exclude leaves out, a rule each: "more than 10 % of the trials spoiled".
[[nodiscard]] std::vector<std::string> exclusion_rules(const Study& study);

/// [any] "mask 68 dB(A), motors 41 dB(A) at the ears, as the lab measured"; empty: nothing was measured.
[[nodiscard]] std::string sound_text(const Study& study);

/// [setup] Reads and checks a study file, without its scene. @throws InputError with one line: FILE:LINE:
/// field = value: what would be right; for an unknown key the nearest valid key.
[[nodiscard]] Study load_study(const std::filesystem::path& file);

/// [setup] As load_study(), from the text of a study file. @param file name for messages and base of paths
[[nodiscard]] Study parse_study(const std::string& text, const std::filesystem::path& file);

/// Where the largest force of a task comes from [N]. Stiffness tasks and inclusions press tissue whose law
/// only the scene knows: their tissue force is 0 here.
struct ForceBound {
  double tissue = 0.0;     // upper end of the force band, or the largest target
  double commanded = 0.0;  // largest commanded force
  double noise = 0.0;      // 6 standard deviations of the largest noise
  [[nodiscard]] double sum() const noexcept { return tissue + commanded + noise; }
};

/// [any] Bound of the force of one task. load_study() requires max_force to be at least its sum.
[[nodiscard]] ForceBound force_bound(const Study& study, const StudyTask& task);

/// The noise of a trial that lasts longer than max_continuous_noise is faded out for this time [s] after
/// every max_continuous_noise: in inclusion and force-control tasks.
inline constexpr double kNoisePause = 0.5;

/// [setup] The scene that a study names: a scene file, relative to the study file, or a built-in organ,
/// pressed as by `palpate run --organ`. Its largest force is at most that of the study. @throws InputError
/// naming the field, with the nearest organ
[[nodiscard]] scene::Overrides scene_of(const Study& study);

// Runs of a task. A number from 2 on is that of the session at whose start it runs again.
inline constexpr int kFirstRun = 0;
inline constexpr int kRunAtEnd = 1;

/// A part of a session: consecutive trials of one task.
struct PlannedPart {
  std::size_t task = 0;
  int run = kFirstRun;  // of the task
  int first_trial = 0;  // of the task, counted over its arms
  int trials = 0;
};

struct PlannedSession {
  std::vector<PlannedPart> parts;
  double minutes = 0.0;
};

/// [setup] Orders of the tasks, as indices: one; or, of a study with latin_order, the rows of a Williams
/// square, which the participants have in turn. Tasks that set a threshold or a force of others come first.
[[nodiscard]] std::vector<std::vector<std::size_t>> task_orders(const Study& study);

/// [setup] Trials of each session of a participant. Tasks are cut into sessions at whole rounds of their
/// arms. Minutes are estimated (docs/study.md). @throws InputError naming sessions or max_minutes when they
/// do not suffice, with the sessions that would
[[nodiscard]] std::vector<PlannedSession> plan_sessions(const Study& study, std::uint32_t participant = 0);

/// [any] Estimated time of a task's trial [s].
[[nodiscard]] double trial_seconds(const Study& study, const StudyTask& task) noexcept;

}  // namespace palpate::study
