#pragma once
#include <cstdint>

#include "palpate/device.h"
#include "palpate/tool_path.h"

namespace palpate::devices {

/// A device that follows a tool path. Its sample depends only on the tick's time; forces have no effect.
class ScriptedDevice final : public haptics::Device {
 public:
  /// [setup] @param path in the device's frame
  explicit ScriptedDevice(scene::ToolPath path) : path_(std::move(path)) {}

  /// [rt] The pose and velocity of the path at `time` [s].
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Ignores the command and returns true.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any] Does nothing.
  void stop() noexcept override {}
  /// [any] Tick number round((end of the path + 0.5 s) x rate).
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;

 private:
  scene::ToolPath path_;
};

}  // namespace palpate::devices
