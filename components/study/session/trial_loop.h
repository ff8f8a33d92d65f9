#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/parameter_updates.h"
#include "palpate/tick_row.h"
#include "palpate/tissue.h"

#include "study/session/course.h"
#include "study/session/interval_meter.h"
#include "study/session/markers.h"
#include "study/session/study.h"
#include "study/session/trial_log.h"

namespace palpate::study {

enum class TrialState {
  kIdle,      // no trial
  kHome,      // the hand moves to the place at which it started, and holds still
  kReach,     // it presses to the force band, or to the target
  kInterval,  // a stimulus interval
  kGap,       // between the intervals; the tool may have to leave the tissue
  kAnswer,    // waits for the answer
  kFinished
};

/// [any] "move to the rest position", ... for the screens.
[[nodiscard]] const char* describe(TrialState state) noexcept;

/// What the screens show of a trial. Nothing in it depends on the condition.
struct TrialView {
  TrialState state = TrialState::kIdle;
  int interval = 0;    // 1 or 2 while it lasts
  bool bar = false;    // the force bar is shown
  double force = 0.0;  // N, tissue force
  double low = 0.0;    // N, band of the bar
  double high = 0.0;
  bool deep_enough = false;  // the prescribed depth is reached: come up
  std::uint64_t tick = 0;
  std::uint32_t fault = 0;  // latched haptics::Fault
};

/// Facts of the scene that the loop uses. SI units.
struct TrialScene {
  double rate_Hz = 1000.0;
  model::TissueParameters tissue;
  std::vector<model::Inclusion> lumps;  // places of the inclusion of kInclusion, one is drawn for each trial
  std::uint64_t lead = 1;               // ticks between a decision and its tick
};

/// One trial after the other in one run: decides by the rows of hand 0 when the stimuli begin and end, and
/// offers them for exact ticks. Call from one thread; in an offline run from the loop's.
class TrialLoop final {
 public:
  /// [setup] The references must outlive this object.
  TrialLoop(const Study& study, TrialScene scene, haptics::ParameterUpdates& updates);

  /// [setup] Calls a function for each marker, with its tick, which may be one of the next ticks.
  void on_marker(std::function<void(MarkerCode, std::uint64_t)> call) { on_marker_ = std::move(call); }
  /// [setup] Begins a trial. The one before must be finished.
  void begin(const Trial& trial);
  /// [setup] Takes the next row of hand 0.
  void row(const haptics::TickRow& row);
  /// [setup] An answer, 1 or 2. Before the end of the second interval it spoils the trial.
  void answer(int interval);
  /// [setup] Ends the search of an interval of an inclusion task, once the tool has touched.
  void next();
  /// [setup] Ends a running trial, which is spoiled.
  void abandon(const std::string& reason);

  [[nodiscard]] const TrialView& view() const noexcept { return view_; }
  [[nodiscard]] bool finished() const noexcept { return view_.state == TrialState::kFinished; }
  /// [any] The trial that runs, or ran last.
  [[nodiscard]] const Trial& trial() const noexcept { return trial_; }
  /// [setup] Adds what was measured to the record of the finished trial.
  void fill_in(TrialRecord& record) const;

 private:
  struct Measured {
    IntervalMeter meter;
    std::uint64_t from_tick = 0;
    std::uint64_t to_tick = 0;
  };

  [[nodiscard]] std::uint64_t ticks(double seconds) const noexcept;
  [[nodiscard]] const StudyTask& task() const noexcept { return study_.tasks[trial_.task]; }
  [[nodiscard]] bool signal_in(int interval) const noexcept { return interval == (trial_.second ? 2 : 1); }

  void enter(TrialState state, std::uint64_t tick);
  void set_tissue(std::uint64_t at);
  void begin_interval(std::uint64_t tick);
  void end_interval(std::uint64_t tick);
  void switch_noise(bool on, std::uint64_t tick);
  void limit_noise(std::uint64_t tick);
  void home(const haptics::TickRow& row);
  void reach(const haptics::TickRow& row);
  void interval(const haptics::TickRow& row);
  void gap(const haptics::TickRow& row);
  void await_answer(const haptics::TickRow& row);
  void measure(const haptics::TickRow& row);
  void check(const haptics::TickRow& row);
  void spoil(const std::string& reason);
  void mark(MarkerCode code, std::uint64_t tick) const {
    if (on_marker_) on_marker_(code, tick);
  }
  void finish(std::uint64_t tick);

  const Study& study_;
  TrialScene scene_;
  haptics::ParameterUpdates& updates_;
  std::function<void(MarkerCode, std::uint64_t)> on_marker_;
  Trial trial_;
  TrialView view_;
  IntervalStimulus stimulus_;  // of the interval
  std::vector<std::string> spoiled_;
  std::array<Measured, 2> measured_{};
  std::optional<std::array<double, 3>> rest_;  // position of the tool at the first row
  std::array<double, 3> last_position_{};
  std::uint64_t since_ = 0;  // tick at which the state began
  std::uint64_t still_since_ = 0;
  std::uint64_t begins_ = 0;  // first tick of the interval that counts
  std::uint64_t ends_ = 0;
  std::uint64_t noise_since_ = 0;
  std::uint64_t noise_again_ = 0;  // tick at which a paused noise goes on; 0: it is not paused
  bool noise_on_ = false;
  int answer_ = 0;
  std::uint64_t answered_ = 0;
};

}  // namespace palpate::study
