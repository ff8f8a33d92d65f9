#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "study/psychophysics/psychophysics.h"
#include "study/session/folder.h"
#include "study/session/study.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// A trial to run.
struct Trial {
  std::size_t task = 0;
  int run = kFirstRun;  // as PlannedPart::run
  bool practice = false;
  bool example = false;  // practice whose answer is shown before
  bool catch_trial = false;
  int number = 0;          // of the trial in its task, or of the practice trial
  int attempt = 1;         // 2 and more: it was spoiled before
  std::size_t arm = 0;     // secret: only for the force that is rendered
  std::string code;        // of the arm, for the log
  double level = 0.0;      // see grid_of(); kForceControl: target [N]
  bool second = false;     // the signal, or the comparison, is in the second interval
  double noise = 0.0;      // N, standard deviation in contact: of the arm, or the level of kNoiseThreshold
  std::uint32_t draw = 0;  // number that random answers to this trial follow from
};

/// Place of a session: which part, and how far.
struct CoursePosition {
  std::size_t part = 0;  // of the session
  std::size_t parts = 0;
  int done = 0;  // trials of the part that are finished or lost
  int of = 0;
};

/// The trials of one participant: a function of study, key, participant and of what the log holds. The next
/// trial follows from the finished trials alone, so a session goes on after a crash as without it.
class Course final {
 public:
  static constexpr int kMaxAttempts = 3;    // of a trial; then it is lost
  static constexpr int kPracticeAgain = 5;  // practice trials after an interruption

  /// [setup] @throws InputError when the plan does not fit
  Course(const Study& study, SealedKey key, std::uint32_t participant);
  ~Course();

  /// [setup] Begins a session, from 1. Trials of sessions before it that were not finished are left out.
  /// @throws InputError for an unknown session, or one whose noise or force was not measured before
  void begin_session(int session);
  /// [setup] The session goes on after an interruption: practice comes first.
  void resume();
  /// [setup] Adds a finished or spoiled trial. @throws InputError when it is not the trial that next()
  /// returns: the log was made by another study or program
  void add(const TrialRecord& trial);
  /// [setup] The next trial of the session; empty: the session is complete.
  [[nodiscard]] std::optional<Trial> next() const;

  /// [setup] Replays a log. @param each called for each trial with the planned one @return sessions that were
  /// begun @throws InputError when a trial does not follow from those before it
  int replay(const ParticipantLog& log,
             const std::function<void(const Trial&, const TrialRecord&)>& each = {});

  [[nodiscard]] CoursePosition position() const;
  /// [setup] Trials of the session that are neither finished nor lost, without practice.
  [[nodiscard]] int trials_left() const;
  /// The own noise threshold that the noise of the present session follows from.
  struct Threshold {
    psychophysics::Estimate log10;  // standard deviation [N]
    int session = 1;                // in which it was measured
    bool at_edge = false;           // at the end of the range of stimuli: not a number to use unseen
    bool above = false;             // at the upper end
  };
  /// [setup] Empty: not measured yet.
  [[nodiscard]] std::optional<Threshold> threshold() const;
  /// [setup] Whether the next trial's noise is a share of the threshold.
  [[nodiscard]] bool uses_threshold() const;
  /// [any] Practice of the present task: trials without examples, the correct ones of the last, and whether
  /// its criterion is met.
  struct Practice {
    int trials = 0;
    int correct = 0;  // of the last PracticeCriterion::of
    bool met = false;
  };
  [[nodiscard]] Practice practice() const;
  /// [any] Whether the last trial ended the practice that a criterion asks for.
  [[nodiscard]] bool training_ended() const noexcept { return training_ended_; }
  /// [any] Trials that were given up, and all spoiled ones.
  [[nodiscard]] int lost() const noexcept { return lost_; }
  [[nodiscard]] int spoiled() const noexcept { return spoiled_; }
  [[nodiscard]] int catch_trials() const noexcept { return catch_trials_; }
  [[nodiscard]] int catch_correct() const noexcept { return catch_correct_; }

 private:
  class Levels;
  struct Slot {
    int number = 0;
    int attempt = 1;
  };
  using RunKey = std::tuple<std::size_t, int, std::size_t>;  // task, run, arm

  void require_measured(std::size_t session) const;
  void begin_part();
  void count(const TrialRecord& trial, const Trial& expected);
  void count_practice(const TrialRecord& trial, const Trial& expected);
  [[nodiscard]] SealedKey key_of(int run) const noexcept;
  [[nodiscard]] std::uint64_t seed_of(int run) const noexcept;
  [[nodiscard]] double easy_signal(const StudyTask& task) const;
  [[nodiscard]] const StudyTask& task_of(const PlannedPart& part) const { return study_.tasks[part.task]; }
  [[nodiscard]] std::size_t arm_of(const PlannedPart& part, int number) const;
  [[nodiscard]] Trial practice_trial() const;
  [[nodiscard]] Trial trial_of(const Slot& slot) const;
  void fill_in(Trial& trial) const;
  [[nodiscard]] double signal_level(const StudyTask& task) const;
  [[nodiscard]] Levels& levels_of(std::size_t task, int run, std::size_t arm) const;

  const Study& study_;
  SealedKey key_;
  std::uint32_t participant_;
  std::vector<PlannedSession> plan_;
  std::vector<std::vector<std::size_t>> arms_of_code_;  // of each task
  mutable std::map<RunKey, std::unique_ptr<Levels>> levels_;

  mutable std::optional<Trial> next_;  // once it was asked for

  std::size_t session_ = 0;  // from 1; 0: none was begun
  std::size_t part_ = 0;
  std::vector<Slot> waiting_;  // of the part, the next one first
  int done_ = 0;
  int practice_left_ = 0;
  int practice_done_ = 0;        // in the task's part
  bool training_ = false;        // practice goes on until its criterion
  bool training_ended_ = false;  // by the last trial
  std::vector<bool> practised_;  // answers that were correct, of practice without examples
  std::uint32_t resumed_ = 0;    // interruptions
  std::uint32_t attempts_ = 0;   // trials of the log without practice
  int lost_ = 0;
  int spoiled_ = 0;
  int catch_trials_ = 0;
  int catch_correct_ = 0;
};

/// [any] Whether the answer was correct. `counted` of a comparison is "comparison is stiffer".
[[nodiscard]] bool counted_answer(const Trial& trial, int answer) noexcept;
[[nodiscard]] bool is_correct(const StudyTask& task, const TrialRecord& trial) noexcept;

/// [setup] The record of a trial, without what was measured.
[[nodiscard]] TrialRecord record_of(const Study& study, const Trial& trial, int session, int block);

}  // namespace palpate::study
