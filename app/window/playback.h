#pragma once
#include <array>
#include <cstdint>

namespace palpate::app {

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

}  // namespace palpate::app
