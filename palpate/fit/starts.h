#pragma once
#include <vector>

#include "palpate/fit/least_squares.h"

namespace palpate::fit {

/// [setup] Points to start from: a coarse search over L_1, q, beta (and relaxation times), with the k_1 and
/// offset that are best for each found by linear least squares; the best `most`, best first, then the best
/// of each L_1 that is not near one of them: a coarse grid judges laws with steep layers badly. Parts begin
/// at the middle of their priors.
[[nodiscard]] std::vector<Solution> starts(const Problem& problem, std::size_t most);

}  // namespace palpate::fit
