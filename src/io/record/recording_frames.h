#pragma once
#include <cstdint>
#include <memory>

#include "palpate/preparation.h"
#include "palpate/recording.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// What a recording looked like at any tick, in any order: for viewers and films. It runs the recording again
/// up to that tick, from the nearest place before it that was kept: every 512 ticks, farther apart in runs of
/// more than 512 x 512. One thread.
class RecordingFrames final {
 public:
  /// [setup] The recording must outlive this. @throws InputError when rows are missing in the middle or the
  /// scene is bad. @param how as for contact::World
  explicit RecordingFrames(const Recording& recording, const contact::Preparation& how = {});
  ~RecordingFrames();
  RecordingFrames(const RecordingFrames&) = delete;
  RecordingFrames& operator=(const RecordingFrames&) = delete;

  [[nodiscard]] std::uint64_t ticks() const noexcept;
  /// [setup] The snapshot after `tick`; its taken_ns is the time since tick 0.
  /// @throws InputError when the recording has no such tick, or lacks what a tick up to it used; others can
  /// still be asked for.
  [[nodiscard]] haptics::Snapshot at(std::uint64_t tick);
  /// [setup] Goes towards `tick`, by at most `most` ticks, so that a caller can think again on a long way.
  /// @return whether it is there, so that at(tick) costs nothing more @throws InputError as at()
  [[nodiscard]] bool approach(std::uint64_t tick, std::uint64_t most);
  /// [any] The tick at which a hand's depth is largest (without contact: its distance smallest).
  [[nodiscard]] std::uint64_t deepest(std::uint32_t hand = 0) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::record
