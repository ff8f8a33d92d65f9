#include <algorithm>

#include "palpate/live_changes.h"

namespace palpate::haptics {

LiveChange live_change(const model::TissueParameters& tissue, const LiveNoise& noise, std::uint32_t what) {
  LiveChange change;
  change.what = what;
  change.tissue = tissue.numbers();
  change.noise = noise;
  std::copy_n(tissue.name.begin(), std::min(tissue.name.size(), change.name.size()), change.name.begin());
  return change;
}

model::TissueParameters tissue_of(const LiveChange& change) {
  const std::string name(change.name.begin(), std::find(change.name.begin(), change.name.end(), '\0'));
  return {change.tissue, name, {}};
}

}  // namespace palpate::haptics
