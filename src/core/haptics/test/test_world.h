#pragma once
#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "core/contact/test/prepared_once.h"
#include "core/haptics/simulation.h"
#include "palpate/mesh.h"
#include "palpate/tick_observer.h"

namespace palpate::haptics::test {

inline constexpr double kBallRadius = 3e-3;  // m

/// A 60 x 60 x 40 mm block whose top is at z = 0, with a 3 mm ball in each hand.
inline SimulationWorld block_and_balls(
    std::size_t hands, double rate_Hz, noise::NoiseSettings noise = {},
    const model::TissueParameters& tissue = model::tissue_preset("gallbladder")) {
  geometry::Tool ball{"ball", {{.name = "ball", .mesh = geometry::make_ball(kBallRadius, 80)}}, kBallRadius};
  const geometry::TriangleMesh block = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  const std::vector<geometry::Tool> tools(hands, ball);
  SimulationWorld world{
      .contact = contact::World(block, tools, tissue, 1.0 / rate_Hz, contact::test::prepared_once()),
      .noise = noise::TouchNoise(noise, rate_Hz),
      .limits = {20.0, 5000.0 / rate_Hz, 0.2, 50.0 / rate_Hz, 1.0 / rate_Hz},
      .mappings = std::vector<WorkspaceMapping>(hands),
      .organ_W = {Quat::Identity(), Vec3(0, 0, -0.02)},
      .rate_Hz = rate_Hz,
  };
  return world;
}

inline noise::NoiseSettings no_noise() {
  noise::NoiseSettings settings;
  settings.enabled = false;
  return settings;
}

/// A straight path from 5 mm above the block down to 5 mm of depth at 20 mm/s, then at rest.
inline DeviceState pressing(double time) {
  DeviceState state;
  state.position_D = Vec3(0.001, 0.002, kBallRadius + std::max(-0.005, 0.005 - 0.02 * time));
  return state;
}

/// A device with samples from a function. It records the written commands.
class FakeDevice final : public Device {
 public:
  explicit FakeDevice(std::function<DeviceState(std::uint64_t, double)> sample)
      : sample_(std::move(sample)) {}

  DeviceState read(std::uint64_t tick, double time) noexcept override { return sample_(tick, time); }
  bool write(const ForceCommand& command) noexcept override {
    last = command;
    if (on_write) on_write(command);
    ++writes;
    return writes != failing_write;
  }
  void stop() noexcept override { ++stops; }
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return ~std::uint64_t{0}; }

  ForceCommand last;
  std::function<void(const ForceCommand&)> on_write;  // called with each command
  std::uint64_t writes = 0;
  std::uint64_t failing_write = 0;  // number of the write that fails; 0: none
  std::atomic<int> stops{0};        // calls of stop(), from any thread

 private:
  std::function<DeviceState(std::uint64_t, double)> sample_;
};

/// Keeps all rows.
class RowKeeper final : public TickObserver {
 public:
  explicit RowKeeper(std::size_t expected) { rows.reserve(expected); }
  void on_start(std::int64_t unix_ns) noexcept override {
    ++begins;
    started = unix_ns;
  }
  void on_row(const TickRow& row) noexcept override {
    if (rows.size() < rows.capacity()) rows.push_back(row);
  }

  std::vector<TickRow> rows;
  int begins = 0;
  std::int64_t started = 0;
};

/// Bitwise equality, except for tick_ns and late_ns.
inline bool same_bits(TickRow a, TickRow b) {
  a.tick_ns = b.tick_ns = 0;
  a.late_ns = b.late_ns = 0;
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are what is compared, -0 and NaN too
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace palpate::haptics::test
