#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "fit/identify/least_squares.h"

namespace palpate::identify {

/// [setup] Tangent of the profile path: derivatives of all parameters (shared first, then each part's own) by
/// parameter `index` when they are refitted, to first order; 1 for that parameter itself. Own parameters are
/// eliminated before the shared ones are solved for. @param index as in parameter_of()
[[nodiscard]] Point profile_tangent(const Problem& problem, const Solution& at, std::size_t index);

/// [setup] Moves one shared parameter (or one of the first part's own) by `step` within the bounds: predicts
/// the others along the tangent, then fits them again with this one held.
[[nodiscard]] Solution profile_step(const Problem& problem, const Solution& at, std::size_t index,
                                    double step);

/// [setup] Profile at `value`: the solution with one parameter held at `value` and all others fitted again.
/// It goes there in several steps, so that it follows a narrow curved path. @param value within
/// the bounds
[[nodiscard]] Solution profile_at(const Problem& problem, Solution at, std::size_t index, double value);

/// [any] A parameter of a solution: shared ones first, then the first part's own.
[[nodiscard]] double parameter_of(const Solution& solution, std::size_t index);

/// [setup] Follows the profile path of one parameter upwards or downwards from `from` while `excess` <= 1,
/// and stops close to where it is 1.
/// @param direction 1 or -1
/// @param excess 0 at the optimum, roughly proportional to the distance from it; infinite where it is
/// undefined
/// @param visit receives each solution on the path; the last has an `excess` of at most 1.1
void follow_profile_path(const Problem& problem, const Solution& from, std::size_t index, double direction,
                         const std::function<double(const Solution&)>& excess,
                         const std::function<void(const Solution&)>& visit);

/// [setup] Sum of squares of each part, priors included. Their sum is cost_of().
[[nodiscard]] std::vector<double> part_costs(const Problem& problem, const Solution& solution);

/// [setup] Whether a solution lies in the confidence set of the best one, for specimens that are independent
/// samples of one tissue: the mean increase of the specimens' costs is within what their spread explains by
/// chance. To first order this is the 95 % interval of a mean with the sandwich variance estimate.
/// @param best, other costs of each part
[[nodiscard]] bool in_confidence_set(const std::vector<double>& best, const std::vector<double>& other);

}  // namespace palpate::identify
