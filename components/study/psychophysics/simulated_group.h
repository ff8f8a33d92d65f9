#pragma once
#include <cstdint>
#include <vector>

#include "core/base/random.h"

#include "study/psychophysics/group_effect.h"
#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

/// A simulated group with interleaved conditions and QUEST+ for each of them. Lapse rates are between 0 and
/// 4 %. Of a comparison, just noticeable differences are between 8 and 22 %, and interval biases have a
/// standard deviation of 0.05 in the logarithm of the ratio. Of a detection, thresholds without noise are
/// normal about mean_threshold with 0.12 decades, and slopes 2.5.
struct SimulatedGroup {
  int people = 24;
  int trials = 60;              // for each condition
  double ratio = 1.0;           // of s with noise to s without
  double heterogeneity = 0.1;   // standard deviation of ln(s with/s off) between people
  double catch_share = 0.0;     // share of trials at the largest level
  double mean_threshold = 0.0;  // log10, of a detection
  std::uint64_t seed = 17;
};

/// [setup] ln s of a person with a just noticeable difference between 8 and 22 %, uniform in its logarithm.
[[nodiscard]] double random_ln_spread(Random& random);

/// [setup] The answers of all people of a group. @param quest of difference_grid() or detection_grid(); is
/// reset
[[nodiscard]] std::vector<PairedCounts> simulate_group(QuestPlus& quest, const SimulatedGroup& group,
                                                       std::uint32_t number);

}  // namespace palpate::psychophysics
