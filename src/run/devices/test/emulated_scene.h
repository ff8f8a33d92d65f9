#pragma once
#include <array>
#include <utility>
#include <vector>

#include "core/contact/test/prepared_once.h"
#include "io/scene/make_world.h"
#include "palpate/mesh.h"
#include "run/devices/emulated.h"
#include "run/realtime/loop.h"

// A scene with an emulated hand that presses a block, for tests of the loop.
namespace palpate::devices::test {

inline constexpr double kBallRadius = 3e-3;  // m
inline constexpr double kRate = 1000.0;      // Hz

/// A 60 x 60 x 40 mm block with its top at z = 0, and one emulated hand with a 3 mm ball.
inline scene::Scene block_and_hand(std::vector<scene::EmulatedFault> faults = {}) {
  scene::Scene scene;
  scene.name = "block";
  scene.rate_Hz = kRate;
  scene.organ_name = "box";
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  scene.tissue = model::tissue_preset("gallbladder");
  scene.tools.push_back(
      {"ball", {{.name = "ball", .mesh = geometry::make_ball(kBallRadius, 80)}}, kBallRadius});
  scene::DeviceSetup& device = scene.devices.emplace_back();
  device.kind = "emulated";
  device.emulated.faults = std::move(faults);
  return scene;
}

/// Path of the ball from its height over the block's top [s, m], linear between the rows.
inline scene::ToolPath heights(const std::vector<std::pair<double, double>>& times_and_heights) {
  std::vector<scene::PathRow> rows;
  for (const auto& [time, height] : times_and_heights) {
    rows.push_back({time, Vec3(0.001, 0.002, kBallRadius + height), Quat::Identity(), 0.0});
  }
  return scene::ToolPath(std::move(rows));
}

/// An emulated device whose user resets a latched fault at given ticks.
class WithResets final : public haptics::Device {
 public:
  WithResets(EmulatedDevice& device, std::vector<std::uint64_t> reset_at)
      : device_(device), reset_at_(std::move(reset_at)) {
    felt.reserve(device.last_tick(kRate));
  }

  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    haptics::DeviceState sample = device_.read(tick, time);
    for (const std::uint64_t at : reset_at_) {
      if (tick == at) sample.events |= haptics::kResetFault;
    }
    return sample;
  }
  bool write(const haptics::ForceCommand& command_D) noexcept override {
    const bool taken = device_.write(command_D);
    if (felt.size() < felt.capacity()) felt.push_back(device_.force_on_hand());
    return taken;
  }
  void stop() noexcept override { device_.stop(); }
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override {
    return device_.last_tick(rate_Hz);
  }

  std::vector<Vec3> felt;  // N, force on the hand after every tick

 private:
  EmulatedDevice& device_;
  std::vector<std::uint64_t> reset_at_;
};

class Rows final : public haptics::TickObserver {
 public:
  explicit Rows(std::size_t expected) { rows.reserve(expected); }
  void on_row(const haptics::TickRow& row) noexcept override {
    if (rows.size() < rows.capacity()) rows.push_back(row);
  }
  std::vector<haptics::TickRow> rows;
};

/// Runs a device to its last tick, offline or in real time. @return the rows
inline std::vector<haptics::TickRow> run_through(const scene::Scene& scene, haptics::Device& device,
                                                 bool offline = true) {
  const haptics::SimulationWorld world = scene::make_world(scene, contact::test::prepared_once());
  haptics::SimulationState state(world);
  const std::uint64_t ticks = device.last_tick(scene.rate_Hz);
  Rows sink(ticks);
  realtime::LoopOptions options;
  options.ticks = ticks;
  options.offline = offline;
  std::array<haptics::Device*, 1> devices = {&device};
  static_cast<void>(realtime::run_loop(world, state, devices, {&sink}, options));
  return std::move(sink.rows);
}

inline Vec3 force_of(const haptics::TickRow& row) { return {row.force[0], row.force[1], row.force[2]}; }

}  // namespace palpate::devices::test
