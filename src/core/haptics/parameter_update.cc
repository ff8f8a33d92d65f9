#include <algorithm>

#include "palpate/parameter_updates.h"

namespace palpate::haptics {

ParameterUpdate parameter_update(const model::TissueParameters& tissue, const LiveNoise& noise,
                                 std::uint32_t what) {
  ParameterUpdate change;
  change.what = what;
  change.tissue = tissue.numbers();
  change.noise = noise;
  if (tissue.size_exponent != 0.0 && tissue.source) change.source_radius = tissue.source->radius;
  std::copy_n(tissue.name.begin(), std::min(tissue.name.size(), change.name.size()), change.name.begin());
  return change;
}

model::TissueParameters tissue_of(const ParameterUpdate& change) {
  const std::string name(change.name.begin(), std::find(change.name.begin(), change.name.end(), '\0'));
  model::TissueParameters tissue{change.tissue, name, {}};
  if (change.source_radius > 0.0) tissue.source = model::SourceParameters{"", change.source_radius};
  return tissue;
}

}  // namespace palpate::haptics
