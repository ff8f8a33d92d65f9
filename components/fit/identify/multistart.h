#pragma once
#include <vector>

#include "fit/identify/least_squares.h"

namespace palpate::identify {

/// [setup] Starting points for the multistart: a coarse grid over L_1, q, beta (and relaxation times). For
/// each grid point, k_1 and offset follow from linear least squares. For each L_1 the best `most` starts that
/// are not neighbours are kept, because a coarse grid underrates laws with steep layers. Own parameters start
/// at the middle of their priors.
[[nodiscard]] std::vector<Solution> multistart_points(const Problem& problem, std::size_t most);

/// [setup] Starting points with one law parameter fixed at `value` [natural logarithm of SI] and the given
/// relaxation: the best `most` that are not neighbours. @param held index of the fixed parameter
[[nodiscard]] std::vector<Solution> multistart_points_at(const Problem& problem, std::size_t held,
                                                         double value, const Point& relaxation,
                                                         std::size_t most);

}  // namespace palpate::identify
