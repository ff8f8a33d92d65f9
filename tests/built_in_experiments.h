#pragma once
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "palpate/scene.h"
#include "run/realtime/loop.h"

namespace palpate::tests {

/// A scene with its devices, ready to run.
struct Rig {
  explicit Rig(scene::Scene resolved);

  scene::Scene scene;
  haptics::SimulationWorld world;
  std::vector<std::unique_ptr<haptics::Device>> devices;

  /// Number of ticks until the paths of all devices end.
  [[nodiscard]] std::uint64_t whole_path() const;
  /// Runs from tick 0 for `options.ticks` ticks.
  haptics::LoopReport run(const std::vector<haptics::TickObserver*>& observers,
                          const realtime::LoopOptions& options);
};

/// An experiment of the paper, "press" (gallbladder) or "pull" (heart), or "moving": the press on an organ
/// with breathing and heartbeat.
Rig built_in(const std::string& task);

/// Keeps all rows of a run.
class RowKeeper final : public haptics::TickObserver {
 public:
  explicit RowKeeper(std::uint64_t expected) { rows.reserve(expected); }
  void on_row(const haptics::TickRow& row) noexcept override { rows.push_back(row); }
  std::vector<haptics::TickRow> rows;
};

/// Whether two rows are equal bit for bit, except the two measured times.
bool same_bits(haptics::TickRow a, haptics::TickRow b);

}  // namespace palpate::tests
