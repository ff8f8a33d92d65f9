#pragma once
#include <array>
#include <cstdint>

#include "core/haptics/simulation.h"
#include "core/haptics/warm_up.h"
#include "io/record/recorder.h"
#include "io/system/temporary.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"

namespace palpate::bench {

/// One hand in a world of one hand, advanced tick by tick without a loop.
class OneHand final {
 public:
  /// [setup] @param world must outlive this object
  explicit OneHand(const haptics::SimulationWorld& world) : world_(&world), state_(world) {}

  /// [setup] Warms the caches, as a run in real time does before its first tick.
  void warm_up() { haptics::warm_up(*world_, state_); }

  /// [rt] Runs the next tick with the device's sample at tick `way` of its path. @return its row
  haptics::TickRow& tick(haptics::Device& device, std::uint64_t way) noexcept {
    samples_[0] = device.read(way, static_cast<double>(way) / world_->rate_Hz);
    haptics::tick(*world_, state_, number_++, samples_, commands_, rows_);
    return rows_[0];
  }

  [[nodiscard]] haptics::TickState tick_state() const noexcept { return {state_, commands_, number_ - 1}; }
  [[nodiscard]] const haptics::DeviceState& sample() const noexcept { return samples_[0]; }

 private:
  const haptics::SimulationWorld* world_;
  haptics::SimulationState state_;
  std::uint64_t number_ = 0;
  std::array<haptics::DeviceState, 1> samples_{};
  std::array<haptics::ForceCommand, 1> commands_{};
  std::array<haptics::TickRow, 1> rows_{};
};

/// A recorder with its writer thread, as in a real-time run, on a temporary file that is deleted at the end.
class ScratchRecorder final {
 public:
  /// [setup] @throws InputError when the file cannot be made.
  explicit ScratchRecorder(const scene::Scene& scene);
  ~ScratchRecorder();
  ScratchRecorder(const ScratchRecorder&) = delete;
  ScratchRecorder& operator=(const ScratchRecorder&) = delete;

  /// [rt]
  void on_row(const haptics::TickRow& row) noexcept { recorder_.on_row(row); }

 private:
  ScratchFolder folder_;
  record::Recorder recorder_;
};

}  // namespace palpate::bench
