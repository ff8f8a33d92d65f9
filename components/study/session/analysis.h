#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/psychophysics/comparisons.h"
#include "study/psychophysics/psychophysics.h"
#include "study/session/folder.h"
#include "study/session/study.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// What a trial rendered besides what its line of the log says.
struct TrialRendering {
  double noise = 0.0;               // N, standard deviation in contact
  std::optional<double> threshold;  // N, own noise threshold that it follows from
  std::array<double, 2> onset{-1.0,
                              -1.0};  // s in the recording of the block; < 0: the interval was not reached
};

/// One person's log and number.
struct Participant {
  std::uint32_t number = 0;
  ParticipantLog log;
  std::vector<TrialRendering> renderings = {};  // of each trial of the log; empty: not asked for
};

/// [setup] Replays a log. @param rate_Hz of the scene @throws InputError when a trial does not follow from
/// those before it
[[nodiscard]] std::vector<TrialRendering> renderings_of(const Study& study, SealedKey key,
                                                        const Participant& person, double rate_Hz);

/// [setup] Everybody's log, by number. @throws InputError as read_log()
[[nodiscard]] std::vector<Participant> read_people(const StudyFolder& study);

/// [setup] The people whose data were deleted.
[[nodiscard]] Deletions deletions_of(std::span<const Participant> people);

/// Answers at one level of the stimulus.
struct Point {
  double level = 0.0;  // see grid_of()
  psychophysics::Count count;
};

/// A person's psychometric function in one arm.
struct ThresholdFit {
  int trials = 0;
  psychophysics::Estimate estimate;    // log10 of the threshold at 75 % [N, ln ratio], or of the JND
  psychophysics::Parameters function;  // posterior means
  bool range_too_small = false;        // the estimate lies at the edge of the stimuli: not a number to report
  std::vector<double> lapses;          // posterior probability of each lapse rate of the grid
};

/// One person's results in one arm of a task. Spoiled trials and practice are left out.
struct ArmResult {
  int trials = 0;
  int spoiled = 0;
  std::map<std::string, int> reasons;  // of spoiled trials
  std::vector<Point> points;
  std::optional<ThresholdFit> fit, first_half, second_half, repeated;
  psychophysics::Count in_first, in_second;               // correct answers, by the interval of the signal
  std::optional<psychophysics::Sensitivity> sensitivity;  // of two intervals, log-linear
  std::optional<double> ln_rms, ln_variation;             // kForceControl: means over trials
  double response_time = 0.0;                             // s, median
};

/// Correlation of the answer with a cue, among trials of the same level and order: 0 for a person who
/// answers by the stiffness alone.
struct CueWeight {
  std::string cue;
  double correlation = 0.0;
  double low = 0.0;  // 99 % interval
  double high = 0.0;
  int trials = 0;
};

/// Change of the log odds of a correct answer from the first to the last trial of a task, given the level.
struct Trend {
  double change = 0.0;
  double z = 0.0;  // change over its standard error
};

/// The noise threshold that the noise of a session follows from.
struct SessionThreshold {
  int session = 1;
  ThresholdFit fit;
};

struct PersonTask {
  std::optional<double> own_level_gain;      // of Study::own_level
  std::vector<ArmResult> arms;               // as TaskResult::arms
  std::vector<SessionThreshold> thresholds;  // of the task that sets the threshold, by session
  std::vector<CueWeight> cues;
  std::optional<Trend> trend;
};

struct PersonResult {
  std::string id;
  bool withdrawn = false;
  std::string observer;  // simulated; empty: a person
  std::vector<PersonTask> tasks;
  // Probability of a lapse rate of at least 5 %, which is the same in all tasks; above 0.75 it is flagged
  double lapses_often = 0.0;
  psychophysics::Count catch_trials;
  int trials = 0;  // that count
  int spoiled = 0;
  double minutes = 0.0;  // of all sessions, from the first trial to the last
  int late_ticks = 0;
  int faults = 0;
  std::optional<psychophysics::Count> audible;  // answers of the audibility check
  bool heard = false;                           // three of four or more were correct: it was heard
  // log10 of the share of the noise threshold that was reached to the share that was meant
  std::optional<psychophysics::Estimate> reached;
  std::vector<std::string> flags;
  std::vector<std::string> exclusions;  // reasons; empty: the person is in the main analysis
  std::vector<std::string> left_out;    // tasks and conditions with too few trials for the group's effects

  [[nodiscard]] bool kept() const noexcept { return !withdrawn && exclusions.empty(); }
};

/// People whom a contrast lacks, and those whose thresholds the stimuli do not reach.
struct Missing {
  int people = 0;  // left out, with fewer than 10 trials in one of the two arms
  int in_condition = 0;
  int in_reference = 0;
  // In the analysis, whose likelihood says that the threshold is at least or at most so large
  int outside_condition = 0;
  int outside_reference = 0;
  // Mean effect if all who are left out had the lowest, or the highest, effect: of a ratio that of the
  // model's range, a factor of 4.5, else of the others
  double low = 0.0;
  double high = 0.0;
};

/// A group's mean effect.
struct Effect {
  int people = 0;
  double effect = 0.0;
  double low = 0.0;  // 95 % interval
  double high = 0.0;
  double p_value = 1.0;          // of the stated alternative
  bool open = false;             // an end of the interval is the end of the model's range: it is wider
  double smallest_effect = 0.0;  // that this study finds with a power of 0.8, see analyse()
  Missing missing = {};
};

/// Comparison of two arms.
struct Contrast {
  std::size_t task = 0;
  std::size_t condition = 0;  // index in TaskResult::arms
  std::size_t reference = 0;
  std::string measure;
  std::string alternative = "two-sided";
  bool primary = false;
  std::optional<Effect> kept;       // without excluded people: the main analysis
  std::optional<Effect> everybody;  // with them
  std::optional<double> holm;       // adjusted p value of an exploratory contrast within its task
};

/// Sensitivity at each share of the noise.
struct Curve {
  std::size_t task = 0;
  std::vector<std::vector<double>> d_primes;           // of each kept person, for each arm
  std::vector<psychophysics::PairedTest> levels;       // mean and interval, for each arm
  std::optional<psychophysics::InvertedU> inverted_u;  // after unblinding
  bool found = false;                                  // both one-sided tests reject at the study's alpha
};

/// Guesses whether the last trial of a block had noise.
struct Guesses {
  std::string who;  // participant or experimenter
  bool noise = false;
  bool pooled = true;  // over all arms, while blind
  int yes = 0;
  int no = 0;
  int unsure = 0;
  double confidence = 0.0;  // mean, 1 to 5
};

/// A mean over the group that would be 0 if nobody tired, learned, adapted or answered by a cue.
struct GroupChange {
  std::size_t task = 0;
  std::string quantity;
  psychophysics::PairedTest test;
};

struct TaskResult {
  std::vector<std::string> arms;  // names: of the arms after unblinding, else A, B, ...; one without: ""
  std::vector<double> shares;     // of each arm, after unblinding
};

struct StudyAnalysis {
  bool unblinded = false;
  std::vector<TaskResult> tasks;
  std::vector<PersonResult> people;  // withdrawn ones too, without their trials
  std::vector<Contrast> contrasts;   // the primary first
  std::vector<Curve> curves;
  std::vector<GroupChange> changes;
  std::vector<Guesses> guesses;
  // d' at each person's own level less that without noise; the level is that with the largest d' in one half
  // of the trials, and d' is of the other half, both ways. After unblinding
  std::optional<Effect> own_level;
  int consented = 0;
  int refused = 0;
  int withdrawn = 0;
  int excluded = 0;
  Deletions deleted;  // people whose data were deleted, and who are in no number above

  /// [any] Whether the results of single people may be shown by arm. While blind, one person's counts beside
  /// the log would show which code has which label.
  [[nodiscard]] bool shows_people(std::size_t task) const noexcept {
    return unblinded || tasks[task].arms.size() == 1;
  }
};

/// [setup] The analysis that the study file fixes. Blind, arms are pooled under the labels A, B, C, all pairs
/// are compared two-sided, and neither the primary contrast nor the inverted U is named.
/// The smallest effect is e = h (t(1 - alpha) + t(0.8))/t(0.975), with h half the width of the 95 % interval,
/// quantiles of Student's t with N - 1 degrees of freedom, and alpha 0.025, or 0.05 for one side.
/// @throws InputError when a log does not fit the study
[[nodiscard]] StudyAnalysis analyse(const Study& study, std::span<const Participant> people, SealedKey key,
                                    bool unblinded);

/// A value in a unit that people read.
struct Readable {
  double value = 0.0;
  const char* unit = "";
};

/// [any] A level of a task: mN, ratio of stiffness, or N.
[[nodiscard]] Readable readable_level(const StudyTask& task, double level) noexcept;
/// [any] An estimate of a task: threshold in mN or as a ratio, JND in per cent.
[[nodiscard]] Readable readable_estimate(const StudyTask& task, double log10_estimate) noexcept;
/// [any] Whether an estimate of ThresholdFit may be stated.
[[nodiscard]] bool is_number(const std::optional<ThresholdFit>& fit) noexcept;

/// [any] Whether the signal, or the stiffer one, was in the second interval.
[[nodiscard]] bool target_second(const StudyTask& task, const TrialRecord& trial) noexcept;

/// The arm of each trial as the analysis shows it.
class ArmNames final {
 public:
  /// [setup]
  ArmNames(const Study& study, SealedKey key, bool unblinded);
  /// [any] For each task.
  [[nodiscard]] const std::vector<TaskResult>& tasks() const noexcept { return tasks_; }
  [[nodiscard]] bool unblinded() const noexcept { return unblinded_; }
  /// [setup] Index in TaskResult::arms of a participant's code. @throws InputError for an unknown code
  [[nodiscard]] std::size_t index_of(std::uint32_t participant, std::size_t task,
                                     const std::string& code) const;
  /// [setup] Whether the arm behind a code has noise; only for the guesses.
  [[nodiscard]] bool has_noise(std::uint32_t participant, std::size_t task, const std::string& code) const;

 private:
  [[nodiscard]] std::size_t arm_of(std::uint32_t participant, std::size_t task,
                                   const std::string& code) const;

  const Study& study_;
  SealedKey key_;
  bool unblinded_;
  std::vector<TaskResult> tasks_;
  std::vector<std::vector<std::size_t>> labels_;
};

}  // namespace palpate::study
