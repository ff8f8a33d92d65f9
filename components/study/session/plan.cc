#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

#include "study/psychophysics/comparisons.h"
#include "study/session/study.h"

namespace palpate::study {
namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr double kSetUp = 90.0;            // s, at the start of a session
constexpr double kAudible = 80.0;          // s, 20 trials of 4 s at the start of the first session
constexpr std::size_t kMaxSessions = 500;  // of the message about too few sessions

/// Time of one session, which fills with trials and the breaks between them.
class SessionClock final {
 public:
  SessionClock(const Study& study, double start) : study_(&study), time_(start) {}

  void add_trial(double seconds) {
    if (trials_ >= study_->break_trials || since_break_ >= study_->break_minutes * kSecondsPerMinute) {
      time_ += study_->break_least;
      trials_ = 0;
      since_break_ = 0.0;
    }
    ++trials_;
    since_break_ += seconds;
    time_ += seconds;
  }
  /// Adds whole rounds of trials while the time is at most `limit` [s]. @return trials that were added
  int add_rounds(int trials, int round, double seconds, double limit) {
    int added = 0;
    while (added < trials) {
      SessionClock longer = *this;
      const int next = std::min(round, trials - added);
      for (int i = 0; i < next; ++i) longer.add_trial(seconds);
      if (longer.time_ > limit) break;
      *this = longer;
      added += next;
    }
    return added;
  }
  [[nodiscard]] double time() const noexcept { return time_; }

 private:
  const Study* study_;
  double time_;               // s
  double since_break_ = 0.0;  // s of trials
  int trials_ = 0;            // since the last break
};

int trials_of(const StudyTask& task) { return task.trials * static_cast<int>(task.arms.size()); }

int round_of(const StudyTask& task) {
  return static_cast<int>(task.two_intervals() ? task.arms.size() : task.targets.size());
}

/// Fills one session after the other.
class Planner final {
 public:
  explicit Planner(const Study& study) : study_(study), limit_(study.max_minutes * kSecondsPerMinute) {}

  std::vector<PlannedSession> plan(const std::vector<std::size_t>& order) {
    begin_session();
    for (const std::size_t task : order) add_task(task);
    end_session();
    return std::move(sessions_);
  }

 private:
  void begin_session() {
    const bool audible = sessions_.empty() && study_.check_audible;
    clock_.emplace(study_, kSetUp + (audible ? kAudible : 0.0));
    sessions_.emplace_back();
    repeats_.clear();
    reserved_ = 0.0;
    const std::optional<std::size_t> threshold = study_.threshold_task();
    if (sessions_.size() > 1 && threshold && study_.tasks[*threshold].each_session) {
      add_run(*threshold, static_cast<int>(sessions_.size()));
    }
    first_parts_ = sessions_.back().parts.size();
  }

  void add_run(std::size_t task, int run) {
    const double seconds = trial_seconds(study_, study_.tasks[task]);
    const int trials = trials_of(study_.tasks[task]);
    for (int i = 0; i < trials; ++i) clock_->add_trial(seconds);
    sessions_.back().parts.push_back({task, run, 0, trials});
  }

  void end_session() {
    for (const std::size_t task : repeats_) add_run(task, kRunAtEnd);
    sessions_.back().minutes = clock_->time() / kSecondsPerMinute;
  }

  /// Largest time [s] of a task's repetition.
  [[nodiscard]] double repetition_time(const StudyTask& task) const {
    if (!task.repeat_at_end) return 0.0;
    const double trials = trials_of(task) * trial_seconds(study_, task);
    const double breaks = 1.0 + static_cast<double>(trials_of(task)) / study_.break_trials +
                          trials / (study_.break_minutes * kSecondsPerMinute);
    return trials + breaks * study_.break_least;
  }

  void add_task(std::size_t index) {
    const StudyTask& task = study_.tasks[index];
    int done = 0;
    while (done < trials_of(task)) {
      const int added = add_part(index, done);
      done += added;
      if (done == trials_of(task)) break;
      if (added == 0 && sessions_.back().parts.size() == first_parts_) fail_round(task);
      if (task.each_session) {
        throw InputError(
            fmt::format("{}: task {}: each_session: its {} must fit into the first session of {} min",
                        study_.file.string(), task.name,
                        counted(static_cast<std::uint64_t>(trials_of(task)), "trial", "trials"),
                        shortest(study_.max_minutes)));
      }
      end_session();
      if (sessions_.size() == kMaxSessions) return;
      begin_session();
    }
    if (!task.repeat_at_end) return;
    repeats_.push_back(index);
    reserved_ += repetition_time(task);
  }

  /// @return the trials of the part; 0: not even a round fits into the session
  int add_part(std::size_t index, int done) {
    const StudyTask& task = study_.tasks[index];
    const double seconds = trial_seconds(study_, task);
    SessionClock clock = *clock_;
    for (int i = 0; done == 0 && i < task.least_practice(); ++i) clock.add_trial(seconds);
    const double limit = limit_ - reserved_ - repetition_time(task);
    const int added = clock.add_rounds(trials_of(task) - done, round_of(task), seconds, limit);
    if (added == 0) return 0;
    clock_ = clock;
    sessions_.back().parts.push_back({index, kFirstRun, done, added});
    return added;
  }

  [[noreturn]] void fail_round(const StudyTask& task) const {
    throw InputError(fmt::format(
        "{}: study.max_minutes = {}: is too short for task {}: must hold its practice, {} of {} s{}",
        study_.file.string(), shortest(study_.max_minutes), task.name,
        counted(static_cast<std::uint64_t>(round_of(task)), "trial", "trials"),
        brief(trial_seconds(study_, task), 3), task.repeat_at_end ? " and its repetition" : ""));
  }

  const Study& study_;
  double limit_;  // s
  std::vector<PlannedSession> sessions_;
  std::optional<SessionClock> clock_;
  std::vector<std::size_t> repeats_;  // tasks to repeat at the end of the session
  std::size_t first_parts_ = 0;       // of the session, before its tasks go on
  double reserved_ = 0.0;             // s, for them
};

}  // namespace

double trial_seconds(const Study& study, const StudyTask& task) noexcept {
  constexpr double kToStart = 0.8;      // s, until the hand holds still
  constexpr double kFades = 0.1;        // s, of the stimulus
  constexpr double kAnswer = 1.2;       // s
  constexpr double kNext = 0.3;         // s, until the next trial begins
  constexpr double kPress = 2.5;        // s, a press to a depth
  constexpr double kReturn = 1.1;       // s, of the hand from the tissue
  constexpr double kSearchShare = 0.8;  // of the search time that people use
  constexpr double kReach = 2.0;        // s, until the target is held
  constexpr double kHold = 6.0;         // s
  const double homing = study.homing_still + kToStart;
  const double choice = homing + task.gap + kFades + kAnswer + kNext;
  if (!task.two_intervals()) return homing + kReach + kHold + kReturn + kNext;
  if (!task.leaves_tissue()) return choice + 2.0 * task.interval;
  const bool search = task.hand() == HandAction::kSearch;
  return choice + 2.0 * ((search ? kSearchShare * task.search_time : kPress) + kReturn);
}

std::vector<std::vector<std::size_t>> task_orders(const Study& study) {
  std::vector<std::size_t> first;
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < study.tasks.size(); ++i) {
    const StudyTask& task = study.tasks[i];
    const bool needed = task.sets_threshold || std::ranges::any_of(study.tasks, [&](const StudyTask& other) {
                          return other.signal && other.signal->task == task.name;
                        });
    (needed || !study.latin_order ? first : free).push_back(i);
  }
  if (free.empty()) return {first};
  std::vector<std::vector<std::size_t>> orders;
  for (const std::vector<int>& row : psychophysics::williams_square(static_cast<int>(free.size()))) {
    orders.push_back(first);
    for (const int place : row) orders.back().push_back(free[static_cast<std::size_t>(place)]);
  }
  return orders;
}

std::vector<PlannedSession> plan_sessions(const Study& study, std::uint32_t participant) {
  const std::vector<std::vector<std::size_t>> orders = task_orders(study);
  std::vector<PlannedSession> sessions = Planner(study).plan(orders[participant % orders.size()]);
  if (sessions.size() > static_cast<std::size_t>(study.sessions)) {
    const std::string enough = sessions.size() == kMaxSessions ? fmt::format("more than {}", kMaxSessions)
                                                               : fmt::format("{}", sessions.size());
    throw InputError(
        fmt::format("{}: study.sessions = {}: the tasks need {} sessions of at most {} min, or longer ones",
                    study.file.string(), study.sessions, enough, shortest(study.max_minutes)));
  }
  return sessions;
}

}  // namespace palpate::study
