#include <algorithm>

#include "palpate/parameter_updates.h"

namespace palpate::haptics {

ParameterUpdate parameter_update(const model::TissueParameters& tissue, const LiveNoise& noise,
                                 std::uint32_t what) {
  ParameterUpdate change;
  change.what = what;
  change.tissue = tissue.numbers();
  change.noise = noise;
  std::copy_n(tissue.name.begin(), std::min(tissue.name.size(), change.name.size()), change.name.begin());
  return change;
}

model::TissueParameters tissue_of(const ParameterUpdate& change) {
  const std::string name(change.name.begin(), std::find(change.name.begin(), change.name.end(), '\0'));
  return {change.tissue, name, {}};
}

}  // namespace palpate::haptics
