#pragma once
#include <vector>

#include "science/identify/least_squares.h"

namespace palpate::identify {

/// [setup] Points to start from: a coarse search over L_1, q, beta (and relaxation times), with the k_1 and
/// offset that are best for each found by linear least squares; of each L_1 the best `most` that are no
/// neighbours, for a coarse grid judges laws with steep layers badly. Parts begin at the middle of their
/// priors.
[[nodiscard]] std::vector<Solution> starts(const Problem& problem, std::size_t most);

/// [setup] The same with one of the law's parameters at `value` [logarithm] and this relaxation: the best
/// `most` that are no neighbours. @param held index of the parameter
[[nodiscard]] std::vector<Solution> starts_at(const Problem& problem, std::size_t held, double value,
                                              const Point& relaxation, std::size_t most);

}  // namespace palpate::identify
