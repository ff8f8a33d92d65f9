#pragma once
#include <cstdint>

#include "palpate/device.h"
#include "palpate/tool_path.h"

namespace palpate::devices {

/// A hand that follows a path in time: its sample depends on the tick's time alone. Forces go nowhere.
class ScriptedDevice final : public haptics::Device {
 public:
  /// [setup]
  explicit ScriptedDevice(scene::ToolPath path) : path_(std::move(path)) {}

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Accepts every command; no hand is there to feel it.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any]
  void stop() noexcept override {}
  /// [any] round((end of the path + 0.5 s) x rate).
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;

 private:
  scene::ToolPath path_;
};

}  // namespace palpate::devices
