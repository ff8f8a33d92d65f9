#pragma once
#include <array>
#include <cstdint>

namespace palpate::app {

/// Where a viewer is in a recording, and how fast it goes on. All members: [any], one thread.
class Playback final {
 public:
  /// Times the recording's own speed.
  static constexpr std::array<double, 5> kSpeeds = {0.1, 0.25, 0.5, 1.0, 2.0};
  /// Pictures a second of the viewer's time, for steps of a picture.
  static constexpr double kPicturesASecond = 30.0;

  /// @param ticks of the recording, at least one @param rate_Hz of its ticks
  Playback(std::uint64_t ticks, double rate_Hz) : last_(static_cast<double>(ticks - 1)), rate_Hz_(rate_Hz) {}

  /// Plays, or stops; at the end it plays from the beginning.
  void toggle();
  void stop() noexcept { playing_ = false; }
  /// Once a frame, while what was asked for is there: so much time has passed for who looks on [s].
  void advance(double seconds);

  /// To a tick, or the last one.
  void go_to(std::uint64_t tick);
  /// So many ticks on, or back; stops.
  void step_ticks(std::int64_t ticks);
  /// As far as so many pictures at this speed are apart, a tick at least; stops.
  void step_pictures(std::int64_t pictures);
  /// So many seconds of the recording on, or back; goes on playing if it does.
  void skip(double seconds);

  /// One of kSpeeds, by its place.
  void choose_speed(std::size_t which);
  /// The next one up or down.
  void change_speed(int by);

  [[nodiscard]] bool playing() const noexcept { return playing_; }
  [[nodiscard]] std::size_t speed() const noexcept { return speed_; }
  [[nodiscard]] std::uint64_t tick() const noexcept { return static_cast<std::uint64_t>(place_); }
  [[nodiscard]] std::uint64_t last() const noexcept { return static_cast<std::uint64_t>(last_); }

 private:
  void move_to(double place);

  double last_;  // ticks
  double rate_Hz_;
  double place_ = 0.0;  // ticks, with what is left of one
  std::size_t speed_ = 3;
  bool playing_ = false;
};

}  // namespace palpate::app
