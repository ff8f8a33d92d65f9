#pragma once
#include <array>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "io/record/recording_frames.h"

#include "app/recorded_view.h"
#include "app/window/plot.h"

namespace palpate::app {

/// Replays a recording on a separate thread, towards the latest requested tick, so that the window stays
/// responsive. All members: [any], one thread.
class ReplayThread final {
 public:
  /// @param frames used only by this thread until the destructor returns
  explicit ReplayThread(record::RecordingFrames& frames);
  ~ReplayThread();
  ReplayThread(const ReplayThread&) = delete;
  ReplayThread& operator=(const ReplayThread&) = delete;

  /// Requests this tick.
  void want(std::uint64_t tick);
  /// Takes the latest snapshot. @return whether it is new
  [[nodiscard]] bool take(haptics::Snapshot& snapshot);
  /// Whether the requested tick has been reached or has failed (failure()).
  [[nodiscard]] bool there();
  /// Why the requested tick cannot be reached; empty: no failure.
  [[nodiscard]] std::string failure();

 private:
  void work();
  void go_to(std::uint64_t tick);
  [[nodiscard]] bool is_there() const { return !failure_.empty() || (reached_any_ && reached_ == wanted_); }

  record::RecordingFrames& frames_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable news_;
  std::uint64_t wanted_ = 0;
  std::uint64_t reached_ = 0;
  bool reached_any_ = false;
  bool taken_ = true;
  bool ending_ = false;
  haptics::Snapshot newest_;
  std::string failure_;  // at the requested tick
  std::thread thread_;
};

/// Playback position and speed in a recording. All members: [any], one thread.
class Playback final {
 public:
  /// Multiples of the recording's own speed.
  static constexpr std::array<double, 5> kSpeeds = {0.1, 0.25, 0.5, 1.0, 2.0};
  /// Pictures per second of playback, for steps by one picture.
  static constexpr double kPicturesASecond = 30.0;

  /// @param ticks number of ticks in the recording, at least one @param rate_Hz ticks per second
  Playback(std::uint64_t ticks, double rate_Hz) : last_(static_cast<double>(ticks - 1)), rate_Hz_(rate_Hz) {}

  /// Plays or stops. At the end of the recording it plays from the beginning.
  void toggle();
  void stop() noexcept { playing_ = false; }
  /// Advances by this elapsed time [s]. Call once per frame when the requested tick has been reached.
  void advance(double seconds);

  /// Moves to a tick, at most the last one.
  void go_to(std::uint64_t tick);
  /// Moves by this number of ticks, forwards or backwards, and stops.
  void step_ticks(std::int64_t ticks);
  /// Moves by this number of pictures at the current speed, at least one tick each, and stops.
  void step_pictures(std::int64_t pictures);
  /// Moves by this recording time [s], forwards or backwards. Playing continues.
  void skip(double seconds);

  /// Selects a speed by its index in kSpeeds.
  void choose_speed(std::size_t which);
  /// Selects a faster or slower speed, by steps in kSpeeds.
  void change_speed(int by);

  [[nodiscard]] bool playing() const noexcept { return playing_; }
  [[nodiscard]] std::size_t speed() const noexcept { return speed_; }
  [[nodiscard]] std::uint64_t tick() const noexcept { return static_cast<std::uint64_t>(place_); }
  [[nodiscard]] std::uint64_t last() const noexcept { return static_cast<std::uint64_t>(last_); }

 private:
  void move_to(double place);

  double last_;  // ticks
  double rate_Hz_;
  double place_ = 0.0;  // ticks, with a fraction
  std::size_t speed_ = 3;
  bool playing_ = false;
};

/// Summary of one hand's whole run.
struct HandOverview {
  /// Contact from tick `first` to `last`, both included.
  struct Contact {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  std::vector<PlotColumn> depth;  // [mm] over time [s], Overview::kColumns of equal width
  double deepest_mm = 0.0;
  std::vector<Contact> contacts;
  std::uint64_t deepest = 0;          // tick of the largest depth
  std::vector<std::uint64_t> faults;  // ticks at which a fault was latched
};

/// Summary of a whole recording, for the timeline and its navigation.
struct Overview {
  static constexpr std::size_t kColumns = 1024;

  std::vector<HandOverview> hands;
  std::vector<std::uint64_t> changes;  // ticks at which tissue or noise parameters change
  double column_width = 0.0;           // s
};

/// [setup] Reads every row once.
[[nodiscard]] Overview overview_of(RecordedView& seen);

/// [any] First fault after a tick; if none follows, the first of the run; nothing without any fault.
[[nodiscard]] std::optional<std::uint64_t> next_fault(const HandOverview& hand, std::uint64_t after);

/// [setup] Tissue and noise parameters in force at a tick.
struct ActiveParameters {
  model::TissueParameters tissue;
  haptics::LiveNoise noise;
};
[[nodiscard]] ActiveParameters active_parameters(const record::Recording& recording, std::uint64_t tick);

}  // namespace palpate::app
