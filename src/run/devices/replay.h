#pragma once
#include <cstdint>
#include <vector>

#include "palpate/device.h"
#include "palpate/tick_row.h"

namespace palpate::devices {

/// A device that repeats the samples of a recording tick by tick, then holds the last one. Forces are
/// ignored.
class ReplayDevice final : public haptics::Device {
 public:
  /// [setup] Takes the samples of one hand, tick 0 first. @throws InputError without any sample.
  explicit ReplayDevice(std::vector<haptics::DeviceState> samples);

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  /// [rt] Accepts and ignores every command.
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  /// [any]
  void stop() noexcept override {}
  /// [any] The number of samples.
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override;

 private:
  std::vector<haptics::DeviceState> samples_;
};

/// [setup] The device samples in a recording's rows that belong to `hand`, in the rows' order.
[[nodiscard]] std::vector<haptics::DeviceState> samples_of_hand(const std::vector<haptics::TickRow>& rows,
                                                                std::size_t hand);

}  // namespace palpate::devices
