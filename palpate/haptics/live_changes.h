#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "palpate/haptics/live_change.h"

namespace palpate::haptics {

struct PreparedChange;
struct SimulationWorld;

/// Hands new tissues and new noise from any thread to a loop that runs. Everything is prepared on the
/// caller's side; the loop takes one a tick, with one copy of plain data, and never waits.
class LiveChanges final {
 public:
  /// Changes that may wait for the loop.
  static constexpr std::size_t kMostWaiting = 8;

  /// What a tissue should be warned of on this scene's devices, in words (scene::stability_remarks).
  using Warnings = std::function<std::vector<std::string>(const model::TissueParameters&)>;

  /// What became of an offer.
  struct Accepted {
    std::uint64_t number = 0;           // Snapshot::change is this, or more, once a tick has used it
    std::vector<std::string> warnings;  // what the stability check says of the new tissue
  };

  /// [setup] @param world of the run, outlives this; @param tissue what the run begins with; @param warnings
  /// may be empty: nobody warns
  LiveChanges(const SimulationWorld& world, const model::TissueParameters& tissue, Warnings warnings);
  ~LiveChanges();
  LiveChanges(const LiveChanges&) = delete;
  LiveChanges& operator=(const LiveChanges&) = delete;

  /// [any] Not for the tick: allocates, and waits for another caller. Another tissue, with its laws,
  /// relaxation, reach, friction, damping and grip limit, from one of the next ticks on.
  /// @throws ParameterError for a bad value, InputError for another reference radius than the run's, or when
  /// kMostWaiting changes wait already; nothing has changed then.
  Accepted offer(const model::TissueParameters& tissue);

  /// [any] As above, for the noise: switched on or off, and its strength; both go over in 50 ms.
  /// @throws ParameterError naming gain_N_m or threshold_mm; InputError as above.
  Accepted offer(const LiveNoise& noise);

  /// [any] What was accepted last, or what the run began with. Not for the tick.
  [[nodiscard]] model::TissueParameters tissue() const;
  [[nodiscard]] LiveNoise noise() const;

  /// [rt] For the loop: the oldest change that waits, or null; it stays until taken().
  [[nodiscard]] const PreparedChange* waiting() const noexcept;
  void taken() noexcept;

 private:
  void hand_over(LiveChange values);

  const SimulationWorld& world_;
  Warnings warnings_;
  mutable std::mutex callers_;  // one at a time; the loop never takes it
  model::TissueParameters tissue_;
  LiveNoise noise_;
  std::uint64_t offered_ = 0;
  std::vector<PreparedChange> slots_;
  alignas(64) std::atomic<std::uint64_t> head_{0};  // changes handed over
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // changes taken
};

}  // namespace palpate::haptics
