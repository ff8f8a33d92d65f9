#pragma once
#include <cstdint>
#include <memory>

#include "palpate/preparation.h"
#include "palpate/recording.h"
#include "palpate/tick_observer.h"

namespace palpate::record {

/// Snapshots of a recording at any tick, in any order: for viewers and videos. Replays the ticks from the
/// nearest stored state before. States are stored every 512 ticks, or farther apart in runs of more than 512
/// x 512 ticks. For one thread.
class RecordingFrames final {
 public:
  /// [setup] @param recording must outlive this @param how as for contact::World @throws InputError when rows
  /// are missing in the middle or the scene is invalid.
  explicit RecordingFrames(const Recording& recording, const contact::Preparation& how = {});
  ~RecordingFrames();
  RecordingFrames(const RecordingFrames&) = delete;
  RecordingFrames& operator=(const RecordingFrames&) = delete;

  [[nodiscard]] std::uint64_t ticks() const noexcept;
  /// [setup] The snapshot after `tick`; its taken_ns is the time since tick 0. @throws InputError when the
  /// recording has no such tick, or lacks data that a tick up to it needs; earlier ticks stay available.
  [[nodiscard]] haptics::Snapshot at(std::uint64_t tick);
  /// [setup] Replays at most `most` ticks towards `tick`, so that the caller can cancel a long replay.
  /// @return whether `tick` is reached, so that at(tick) is immediate @throws InputError as at().
  [[nodiscard]] bool approach(std::uint64_t tick, std::uint64_t most);
  /// [any] The tick of a hand's largest depth; without contact, of its smallest distance.
  [[nodiscard]] std::uint64_t deepest(std::uint32_t hand = 0) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::record
