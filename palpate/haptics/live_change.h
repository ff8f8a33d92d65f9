#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "palpate/model/tissue.h"
#include "palpate/noise/touch_noise.h"

namespace palpate::haptics {

/// What of the touch noise may change while a run goes on; its clock and its seed stay.
struct LiveNoise {
  bool enabled = true;
  double gain = 5e-5;       // K [N m]
  double threshold = 5e-3;  // d0 [m]

  bool operator==(const LiveNoise&) const = default;
};

/// Bits of LiveChange::what.
inline constexpr std::uint32_t kTissueChanged = 1U << 0;
inline constexpr std::uint32_t kNoiseChanged = 1U << 1;

/// One change to a run under way: what is in force from its tick on, whole, and which of it is new. Plain
/// data, so that it can be handed from thread to thread with one copy.
struct LiveChange {
  static constexpr std::size_t kNameBytes = 64;

  std::uint64_t tick = 0;    // the first that used it
  std::uint64_t number = 0;  // from 1 on, in the order in which changes were offered
  std::uint32_t what = 0;    // kTissueChanged, kNoiseChanged
  model::TissueNumbers tissue;
  LiveNoise noise;
  std::array<char, kNameBytes> name{};  // the tissue's, cut off and filled up with zeros

  bool operator==(const LiveChange&) const = default;
};
static_assert(std::is_trivially_copyable_v<LiveChange>);

/// [setup] A change to this tissue and noise. @param what which of the two is new
[[nodiscard]] LiveChange live_change(const model::TissueParameters& tissue, const LiveNoise& noise,
                                     std::uint32_t what);

/// [setup] The tissue of a change, not checked; it has no [source].
[[nodiscard]] model::TissueParameters tissue_of(const LiveChange& change);

}  // namespace palpate::haptics
