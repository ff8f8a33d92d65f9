#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/histogram.h"
#include "run/realtime/tick_wait.h"

namespace palpate::haptics {

enum class Verdict { kGood, kBad, kUnknown };

/// One thing that real time needs of a machine.
struct MachineCheck {
  std::string name;  // "real-time priority"
  Verdict verdict = Verdict::kUnknown;
  std::string found;   // what there is, in words
  std::string advice;  // what to do; empty when it is good
};

/// [setup] What the files under /proc and /sys say about this machine and process, in a fixed order:
/// priority, memory lock, real-time throttling, timer slack, timers and clock, kernel, processors, their
/// frequency. A file that is missing or unreadable gives kUnknown, never an error.
/// @param root in place of /, for tests
[[nodiscard]] std::vector<MachineCheck> check_machine(const std::filesystem::path& root = "/");

/// How late a thread gets on that does nothing but wait for the loop's deadlines.
struct WakeUps {
  Histogram late;                  // ns
  std::uint64_t missed = 0;        // a full period or more late
  bool realtime_priority = false;  // what the measuring thread was granted
  bool memory_locked = false;
};

/// [setup] Measures for ticks / rate_Hz seconds on a thread that asks for all that the loop asks for.
[[nodiscard]] WakeUps measure_wake_ups(double rate_Hz, std::uint64_t ticks, Waiting waiting);

}  // namespace palpate::haptics
