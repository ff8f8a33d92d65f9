#pragma once
#include "palpate/tissue.h"

#include "fit/identify/map_choice.h"

namespace palpate::identify {

/// A tissue with the smooth law, near the background of a map.
struct MapTissue {
  model::TissueParameters tissue;
  double error = 0.0;  // largest difference of the forces, as a fraction of the largest force
};

/// [setup] The tissue with the smooth law that is nearest to the uniform background of a map, from D = 0 to
/// the deepest row. @param deepest depth of the rows [m]
[[nodiscard]] MapTissue tissue_of_map(const FittedMap& map, double deepest);

}  // namespace palpate::identify
