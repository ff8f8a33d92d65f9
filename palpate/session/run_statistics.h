#pragma once
#include <cstdint>
#include <vector>

namespace palpate::session {

/// A stretch of ticks that one hand spent in one phase.
struct PhaseSpan {
  std::uint32_t hand = 0;
  std::uint32_t phase = 0;  // contact::Phase
  double from = 0.0;        // s
  double to = 0.0;          // s, of the first tick after it
};

/// Peaks and counts over the rows of a run.
struct RunStatistics {
  static constexpr std::size_t kMaxSpans = 256;

  double peak_force = 0.0;   // N, at the device
  double peak_tissue = 0.0;  // N, before the gate
  double peak_depth = 0.0;   // m
  std::uint64_t deepest_tick = 0;
  std::uint32_t deepest_hand = 0;
  std::uint64_t contact_ticks = 0;  // ticks with a hand pressing or pulling
  std::uint64_t limited_ticks = 0;  // ticks in which the gate shortened a force or torque
  std::uint32_t status = 0;         // all bits seen
  std::uint64_t changes = 0;        // of tissue or noise parameters during the run
  std::vector<PhaseSpan> phases;    // in order of their begin
  std::uint64_t phases_left_out = 0;
};

}  // namespace palpate::session
