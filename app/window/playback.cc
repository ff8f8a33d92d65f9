#include "app/window/playback.h"

#include <algorithm>
#include <cmath>

namespace palpate::app {

void Playback::move_to(double place) { place_ = std::clamp(place, 0.0, last_); }

void Playback::toggle() {
  playing_ = !playing_;
  if (playing_ && place_ >= last_) place_ = 0.0;
}

void Playback::advance(double seconds) {
  if (!playing_) return;
  move_to(place_ + seconds * kSpeeds[speed_] * rate_Hz_);
  if (place_ >= last_) playing_ = false;
}

void Playback::go_to(std::uint64_t tick) { move_to(static_cast<double>(std::min(tick, last()))); }

void Playback::step_ticks(std::int64_t ticks) {
  playing_ = false;
  move_to(std::floor(place_) + static_cast<double>(ticks));
}

void Playback::step_pictures(std::int64_t pictures) {
  const double apart = std::max(1.0, std::round(rate_Hz_ * kSpeeds[speed_] / kPicturesASecond));
  step_ticks(pictures * static_cast<std::int64_t>(apart));
}

void Playback::skip(double seconds) { move_to(std::floor(place_) + std::round(seconds * rate_Hz_)); }

void Playback::choose_speed(std::size_t which) { speed_ = std::min(which, kSpeeds.size() - 1); }

void Playback::change_speed(int by) {
  const auto most = static_cast<std::int64_t>(kSpeeds.size()) - 1;
  speed_ =
      static_cast<std::size_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(speed_) + by, 0, most));
}

}  // namespace palpate::app
