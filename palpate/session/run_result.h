#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/haptics/run_control.h"
#include "palpate/session/run_statistics.h"

namespace palpate::session {

/// How a run went.
struct RunResult {
  std::string scene;  // its name
  double rate_Hz = 0.0;
  std::uint64_t seed = 0;
  std::size_t hands = 0;
  std::vector<std::string> scene_remarks;  // repairs of its meshes, and what the user should know of it
  bool offline = false;
  haptics::LoopReport loop;
  RunStatistics statistics;
  std::filesystem::path fault_recording;  // the last ticks before a fault of an unrecorded run; empty: none
};

}  // namespace palpate::session
