#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "palpate/device.h"
#include "palpate/scene.h"

namespace palpate::devices {

/// An emulated device's faults, in ticks: what each does to a sample.
class FaultSchedule final {
 public:
  static constexpr double kSpike = 50e-3;  // m

  /// [setup] @throws ParameterError when a time or duration is not >= 0, or an age not in (0, 1 s].
  FaultSchedule(const std::vector<scene::EmulatedFault>& faults, double rate_Hz);

  /// [rt] What the device says at a tick instead of `fresh`, a sample of that tick. Called once a tick, ticks
  /// rising. Faults at one time work one after the other, in the scene's order.
  [[nodiscard]] haptics::DeviceState spoil(std::uint64_t tick, const haptics::DeviceState& fresh) noexcept;

  /// [rt] Whether a fault of that kind is on at the tick.
  [[nodiscard]] bool on(scene::EmulatedFaultKind kind, std::uint64_t tick) const noexcept;
  /// [rt] The first fault that is on, in the scene's order.
  [[nodiscard]] std::optional<scene::EmulatedFaultKind> first_on(std::uint64_t tick) const noexcept;

 private:
  struct Span {
    scene::EmulatedFaultKind kind;
    std::uint64_t begin;  // first tick
    std::uint64_t end;    // first tick after
    std::uint64_t delay;  // ticks, of late samples
    [[nodiscard]] bool holds(std::uint64_t tick) const noexcept { return tick >= begin && tick < end; }
  };

  [[nodiscard]] haptics::DeviceState delayed(std::uint64_t delay) const noexcept;
  void apply(const Span& span, std::uint64_t tick, haptics::DeviceState& sample) const noexcept;

  double rate_Hz_;
  std::vector<Span> spans_;
  std::vector<haptics::DeviceState> past_;  // ring of samples, as many as the longest delay needs
  std::uint64_t kept_ = 0;                  // samples put into it so far
  haptics::DeviceState frozen_;             // the last sample before a freeze
  std::uint64_t frozen_tick_ = 0;
};

}  // namespace palpate::devices
