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

#include "palpate/inclusion.h"
#include "palpate/tissue.h"
#include "palpate/touch_noise.h"

namespace palpate::haptics {

/// Touch-noise parameters that may change during a run. Rate and seed stay constant.
struct LiveNoise {
  bool enabled = true;
  double gain = 5e-5;       // K [N m]
  double threshold = 5e-3;  // d0 [m]

  bool operator==(const LiveNoise&) const = default;
};

/// Numbers of an inclusion that may change during a run. Radius and pulse stay constant.
struct LiveInclusion {
  std::uint32_t index = 0;           // of the inclusion, from 0, in the scene's order
  std::array<double, 3> centre_S{};  // organ frame [m]
  double ratio = 1.0;                // stiffness ratio

  bool operator==(const LiveInclusion&) const = default;
};

/// A commanded force on every hand, for experiments with people. It acts along the direction of the touch
/// noise, and both share one energy limit.
struct LiveStimulus {
  double force = 0.0;          // N, positive away from the tissue
  double ramp = 50e-3;         // s, duration of the linear ramp from the force before to this one
  std::uint32_t interval = 0;  // number of the stimulus interval that this update begins; 0: none

  bool operator==(const LiveStimulus&) const = default;
};

/// Bits of ParameterUpdate::what.
inline constexpr std::uint32_t kTissueChanged = 1U << 0;
inline constexpr std::uint32_t kNoiseChanged = 1U << 1;
inline constexpr std::uint32_t kInclusionChanged = 1U << 2;
inline constexpr std::uint32_t kStimulusChanged = 1U << 3;

/// One update of tissue, noise, an inclusion or the commanded force during a run. It holds the tissue and
/// noise that apply from `tick` on, and at most one inclusion or commanded force; `what` marks the parts that
/// are new. It is plain data, so one copy passes it to another thread.
struct ParameterUpdate {
  static constexpr std::size_t kNameBytes = 64;

  std::uint64_t tick = 0;    // first tick that uses the update
  std::uint64_t number = 0;  // 1, 2, ... in the order of the calls of offer()
  std::uint32_t what = 0;    // bits kTissueChanged, kNoiseChanged, kInclusionChanged, kStimulusChanged
  model::TissueNumbers tissue;
  LiveNoise noise;
  LiveInclusion inclusion;              // only with kInclusionChanged
  LiveStimulus stimulus;                // only with kStimulusChanged
  double source_radius = 0.0;           // m, of the tissue's source; 0: a tissue without size exponent
  std::array<char, kNameBytes> name{};  // name of the tissue, truncated or padded with zeros

  bool operator==(const ParameterUpdate&) const = default;
};
static_assert(std::is_trivially_copyable_v<ParameterUpdate>);

/// [setup] An update with this tissue and noise. @param what kTissueChanged, kNoiseChanged or both: the new
/// part
[[nodiscard]] ParameterUpdate parameter_update(const model::TissueParameters& tissue, const LiveNoise& noise,
                                               std::uint32_t what);

/// [setup] The tissue of an update. It is not validated, and without a size exponent its `source` is empty.
[[nodiscard]] model::TissueParameters tissue_of(const ParameterUpdate& change);

struct PreparedUpdate;
struct SimulationWorld;

/// Passes new tissue and noise parameters from any thread to a running loop. The calling thread checks and
/// prepares each update. The loop takes at most one update per tick with one copy of plain data and never
/// waits.
///
/// An update with a `not_before_tick` is taken at the first tick that is not less, so 0 is the next tick. The
/// loop takes the updates in the order of the calls: a later update waits behind an earlier one.
class ParameterUpdates final {
 public:
  /// Largest number of updates that wait for the loop.
  static constexpr std::size_t kMaxWaiting = 32;

  /// Returns the stability warnings for a tissue and its inclusions with this scene's devices
  /// (scene::stability_remarks).
  using Warnings = std::function<std::vector<std::string>(const model::TissueParameters&,
                                                          const std::vector<model::Inclusion>&)>;

  /// Result of offer().
  struct Accepted {
    std::uint64_t number = 0;           // Snapshot::change is at least this once a tick has used the update
    std::vector<std::string> warnings;  // stability warnings for the new tissue or inclusion
  };

  /// [setup] @param world of the run; must outlive this object @param tissue at the start of the run
  /// @param warnings empty: no stability check
  ParameterUpdates(const SimulationWorld& world, const model::TissueParameters& tissue, Warnings warnings);
  ~ParameterUpdates();
  ParameterUpdates(const ParameterUpdates&) = delete;
  ParameterUpdates& operator=(const ParameterUpdates&) = delete;

  /// [any] Replaces the tissue at one of the next ticks: law, relaxation, displacement profile, friction,
  /// damping and grip limit. It allocates and may wait for another caller, so do not call it from the tick.
  /// @throws ParameterError for an invalid value; InputError for a reference radius that differs from the
  /// run's, for other layers where a tool is a needle, or when kMaxWaiting updates wait already. After an
  /// exception nothing has changed.
  Accepted offer(const model::TissueParameters& tissue, std::uint64_t not_before_tick = 0);

  /// [any] Switches the touch noise on or off and sets its strength at one of the next ticks. The crossfade
  /// takes 50 ms. It allocates and may wait for another caller, so do not call it from the tick.
  /// @throws ParameterError that names gain_N_m or threshold_mm; InputError when kMaxWaiting updates wait
  /// already. After an exception nothing has changed.
  Accepted offer(const LiveNoise& noise, std::uint64_t not_before_tick = 0);

  /// [any] Moves an inclusion and sets its stiffness ratio at one of the next ticks. It allocates and may
  /// wait for another caller, so do not call it from the tick.
  /// @throws ParameterError for a ratio out of range; InputError when the scene has no inclusion of this
  /// index, when it would not be inside the organ, or when kMaxWaiting updates wait already.
  Accepted offer(const LiveInclusion& inclusion, std::uint64_t not_before_tick = 0);

  /// [any] Changes the commanded force at one of the next ticks, which makes the first step of the ramp. A
  /// fault sets it to zero on its hand until the next update. It allocates and may wait for another caller,
  /// so do not call it from the tick.
  /// @throws ParameterError that names force_N (at most the run's largest force), ramp_ms (10 to 10000) or
  /// interval (0 to 2); InputError when kMaxWaiting updates wait already.
  Accepted offer(const LiveStimulus& stimulus, std::uint64_t not_before_tick = 0);

  /// [any] The parameters of the last accepted update, or those at the start of the run. May wait for another
  /// caller, so do not call them from the tick.
  [[nodiscard]] model::TissueParameters tissue() const;
  [[nodiscard]] LiveNoise noise() const;
  [[nodiscard]] std::vector<model::Inclusion> inclusions() const;

  /// [rt] For the loop: the oldest update that waits, or null when this tick must not take it yet. It stays
  /// valid until taken().
  [[nodiscard]] const PreparedUpdate* waiting(std::uint64_t tick) const noexcept;
  /// [rt] For the loop: removes the update that waiting() returned.
  void taken() noexcept;

 private:
  void hand_over(ParameterUpdate values, std::uint64_t not_before_tick);

  const SimulationWorld& world_;
  Warnings warnings_;
  mutable std::mutex callers_;  // one caller at a time; the loop never locks it
  model::TissueParameters tissue_;
  LiveNoise noise_;
  std::vector<model::Inclusion> inclusions_;
  std::uint64_t offered_ = 0;
  std::vector<PreparedUpdate> slots_;
  alignas(64) std::atomic<std::uint64_t> head_{0};  // number of updates passed to the loop
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // number of updates taken by the loop
};

}  // namespace palpate::haptics
