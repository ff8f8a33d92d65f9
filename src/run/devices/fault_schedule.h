#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "palpate/device.h"
#include "palpate/scene.h"

namespace palpate::devices {

/// The faults of an emulated device by tick, and how each changes a sample.
class FaultSchedule final {
 public:
  static constexpr double kSpike = 50e-3;  // m

  /// [setup] @throws ParameterError when a time or duration is not >= 0, or an age not in (0, 1 s].
  FaultSchedule(const std::vector<scene::EmulatedFault>& faults, double rate_Hz);

  /// [rt] The sample `fresh` as the faults of this tick change it. Call once per tick, in rising order.
  /// Simultaneous faults apply in the scene's order.
  [[nodiscard]] haptics::DeviceState with_faults(std::uint64_t tick,
                                                 const haptics::DeviceState& fresh) noexcept;

  /// [rt] Whether a fault of that kind is active at the tick.
  [[nodiscard]] bool is_active(scene::EmulatedFaultKind kind, std::uint64_t tick) const noexcept;
  /// [rt] The first active fault, in the scene's order.
  [[nodiscard]] std::optional<scene::EmulatedFaultKind> first_active(std::uint64_t tick) const noexcept;

 private:
  struct Span {
    scene::EmulatedFaultKind kind;
    std::uint64_t begin;  // first tick
    std::uint64_t end;    // first tick after the fault
    std::uint64_t delay;  // ticks by which samples are late
    [[nodiscard]] bool holds(std::uint64_t tick) const noexcept { return tick >= begin && tick < end; }
  };

  [[nodiscard]] haptics::DeviceState delayed(std::uint64_t delay) const noexcept;
  void apply(const Span& span, std::uint64_t tick, haptics::DeviceState& sample) const noexcept;

  double rate_Hz_;
  std::vector<Span> spans_;
  std::vector<haptics::DeviceState> past_;  // ring of samples, as many as the longest delay needs
  std::uint64_t kept_ = 0;                  // samples stored so far
  haptics::DeviceState frozen_;             // the last sample before a freeze
  std::uint64_t frozen_tick_ = 0;
};

}  // namespace palpate::devices
