#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "palpate/base/pose.h"
#include "palpate/contact/tool_contact.h"
#include "palpate/haptics/device.h"
#include "palpate/model/tissue.h"

namespace palpate::haptics {

struct SimulationState;

/// The state after one tick, for pictures and for other programs. Plain data, so that it can be handed from
/// thread to thread.
struct Snapshot {
  static constexpr std::size_t kMaxHands = 4;
  std::uint64_t tick = 0;
  std::int64_t taken_ns = 0;  // when the tick began, monotonic clock; 0 in an offline run
  Pose organ_W;               // at that tick
  std::uint32_t hands = 0;
  std::array<contact::ToolInput, kMaxHands> tools{};
  std::array<contact::ToolResult, kMaxHands> results{};
  std::array<ForceCommand, kMaxHands> commands{};  // world frame
  std::array<Fault, kMaxHands> faults{};           // latched
  std::uint64_t change = 0;                        // number of the last live change in force; 0: none
  model::ReachParameters reach;                    // of the tissue in force

  /// [rt] The contact of each hand.
  [[nodiscard]] std::span<const contact::ToolResult> hand_results() const noexcept {
    return {results.data(), std::min<std::size_t>(hands, kMaxHands)};
  }
};

/// [rt] Fills in the state after a tick (entries of hands that the scene lacks stay as they are).
/// @param commands what tick() returned, one a hand, world frame
/// @param taken_ns when the tick began, by the monotonic clock
void make_snapshot(const SimulationState& state, std::span<const ForceCommand> commands, std::uint64_t tick,
                   std::int64_t taken_ns, Snapshot& snapshot) noexcept;

}  // namespace palpate::haptics
