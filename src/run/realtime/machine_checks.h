#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/histogram.h"
#include "run/realtime/tick_wait.h"

namespace palpate::realtime {

enum class Verdict { kGood, kBad, kUnknown };

/// One requirement of real time on a machine.
struct MachineCheck {
  std::string name;  // "real-time priority"
  Verdict verdict = Verdict::kUnknown;
  std::string found;   // the present state
  std::string advice;  // remedy; empty for kGood
};

/// [setup] Checks this machine and process by the files under /proc and /sys, in a fixed order:
/// priority, memory lock, real-time throttling, timer slack, timers and clock, kernel, processors, their
/// frequency. A file that is missing or unreadable gives kUnknown, never an error.
/// @param root in place of /, for tests
[[nodiscard]] std::vector<MachineCheck> check_machine(const std::filesystem::path& root = "/");

/// Wake-up latency of a thread that only waits for the loop's deadlines.
struct WakeUpLatency {
  haptics::Histogram late;         // ns
  std::uint64_t missed = 0;        // wake-ups a full period or more late
  bool realtime_priority = false;  // granted to the measuring thread
  bool memory_locked = false;
};

/// [setup] Measures for ticks / rate_Hz seconds on a thread with the loop's settings.
[[nodiscard]] WakeUpLatency measure_wake_up_latency(double rate_Hz, std::uint64_t ticks,
                                                    haptics::Waiting waiting);

}  // namespace palpate::realtime
