#pragma once
#include <array>
#include <cstdint>

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
/// data, SI, so that it can be handed from thread to thread and recorded.
struct LiveChange {
  static constexpr std::size_t kNameBytes = 64;

  std::uint64_t tick = 0;         // the first that used it
  std::uint64_t number = 0;       // from 1 on, in the order in which changes were offered
  std::uint32_t what = 0;         // kTissueChanged, kNoiseChanged
  std::uint32_t law = 0;          // model::LawKind
  double k1 = 0.0;                // N/m
  double beta = 0.0;              // eq. 3
  double q = 0.0;                 // eq. 4
  double rest_length = 0.0;       // m
  double max_length = 0.0;        // m
  double min_length = 0.0;        // m
  double t1 = 0.0;                // s
  std::array<double, 3> share{};  // of each relaxation term; 0: there is none
  std::array<double, 3> time{};   // s
  double contact_ratio = 0.0;     // of the reach
  double first_bar_ratio = 0.0;
  double bar_ratio = 0.0;
  double weight_ratio = 0.0;
  double depth_exponent = 0.5;  // as of a recording from before it was a parameter
  double friction = 0.0;
  double tangential_stiffness = 0.0;      // N/m; 0: not given
  double damping = 0.0;                   // N s/m
  double reference_radius = 0.0;          // m
  double grip_limit = 0.0;                // N
  std::uint64_t noise_enabled = 0;        // 0 or 1
  double noise_gain = 0.0;                // N m
  double noise_threshold = 0.0;           // m
  std::array<char, kNameBytes> tissue{};  // its name, cut off and filled up with zeros

  bool operator==(const LiveChange&) const = default;
};
static_assert(model::kMostRelaxationTerms == 3, "LiveChange has as many");

/// [setup] A change to this tissue and noise. @param what which of the two is new
[[nodiscard]] LiveChange live_change(const model::TissueParameters& tissue, const LiveNoise& noise,
                                     std::uint32_t what);

/// [setup] The tissue of a change, not checked; it has no [source].
[[nodiscard]] model::TissueParameters tissue_of(const LiveChange& change);

/// [any] The reach of a change, not checked.
[[nodiscard]] model::ReachParameters reach_of(const LiveChange& change) noexcept;

/// [any] The noise of a change, not checked.
[[nodiscard]] LiveNoise noise_of(const LiveChange& change) noexcept;

}  // namespace palpate::haptics
