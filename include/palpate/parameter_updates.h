#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

#include "palpate/tissue.h"
#include "palpate/touch_noise.h"

namespace palpate::haptics {

/// What of the touch noise may change while a run goes on; its clock and its seed stay.
struct LiveNoise {
  bool enabled = true;
  double gain = 5e-5;       // K [N m]
  double threshold = 5e-3;  // d0 [m]

  bool operator==(const LiveNoise&) const = default;
};

/// Bits of ParameterUpdate::what.
inline constexpr std::uint32_t kTissueChanged = 1U << 0;
inline constexpr std::uint32_t kNoiseChanged = 1U << 1;

/// One change to a run under way: what is in force from its tick on, whole, and which of it is new. Plain
/// data, so that it can be handed from thread to thread with one copy.
struct ParameterUpdate {
  static constexpr std::size_t kNameBytes = 64;

  std::uint64_t tick = 0;    // the first that used it
  std::uint64_t number = 0;  // from 1 on, in the order in which changes were offered
  std::uint32_t what = 0;    // kTissueChanged, kNoiseChanged
  model::TissueNumbers tissue;
  LiveNoise noise;
  std::array<char, kNameBytes> name{};  // the tissue's, cut off and filled up with zeros

  bool operator==(const ParameterUpdate&) const = default;
};
static_assert(std::is_trivially_copyable_v<ParameterUpdate>);

/// [setup] A change to this tissue and noise. @param what which of the two is new
[[nodiscard]] ParameterUpdate parameter_update(const model::TissueParameters& tissue, const LiveNoise& noise,
                                               std::uint32_t what);

/// [setup] The tissue of a change, not checked; it has no [source].
[[nodiscard]] model::TissueParameters tissue_of(const ParameterUpdate& change);

struct PreparedUpdate;
struct SimulationWorld;

/// Hands new tissues and new noise from any thread to a loop that runs. Everything is prepared on the
/// caller's side; the loop takes one a tick, with one copy of plain data, and never waits.
class ParameterUpdates final {
 public:
  /// Changes that may wait for the loop.
  static constexpr std::size_t kMaxWaiting = 8;

  /// What a tissue should be warned of on this scene's devices, in words (scene::stability_remarks).
  using Warnings = std::function<std::vector<std::string>(const model::TissueParameters&)>;

  /// What became of an offer.
  struct Accepted {
    std::uint64_t number = 0;           // Snapshot::change is this, or more, once a tick has used it
    std::vector<std::string> warnings;  // what the stability check says of the new tissue
  };

  /// [setup] @param world of the run, outlives this; @param tissue what the run begins with; @param warnings
  /// may be empty: nobody warns
  ParameterUpdates(const SimulationWorld& world, const model::TissueParameters& tissue, Warnings warnings);
  ~ParameterUpdates();
  ParameterUpdates(const ParameterUpdates&) = delete;
  ParameterUpdates& operator=(const ParameterUpdates&) = delete;

  /// [any] Not for the tick: allocates, and waits for another caller. Another tissue, with its laws,
  /// relaxation, reach, friction, damping and grip limit, from one of the next ticks on.
  /// @throws ParameterError for a bad value, InputError for another reference radius than the run's, or when
  /// kMaxWaiting changes wait already; nothing has changed then.
  Accepted offer(const model::TissueParameters& tissue);

  /// [any] As above, for the noise: switched on or off, and its strength; both go over in 50 ms.
  /// @throws ParameterError naming gain_N_m or threshold_mm; InputError as above.
  Accepted offer(const LiveNoise& noise);

  /// [any] What was accepted last, or what the run began with. Not for the tick.
  [[nodiscard]] model::TissueParameters tissue() const;
  [[nodiscard]] LiveNoise noise() const;

  /// [rt] For the loop: the oldest change that waits, or null; it stays until taken().
  [[nodiscard]] const PreparedUpdate* waiting() const noexcept;
  void taken() noexcept;

 private:
  void hand_over(ParameterUpdate values);

  const SimulationWorld& world_;
  Warnings warnings_;
  mutable std::mutex callers_;  // one at a time; the loop never takes it
  model::TissueParameters tissue_;
  LiveNoise noise_;
  std::uint64_t offered_ = 0;
  std::vector<PreparedUpdate> slots_;
  alignas(64) std::atomic<std::uint64_t> head_{0};  // changes handed over
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // changes taken
};

}  // namespace palpate::haptics
