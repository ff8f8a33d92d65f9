#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "science/identify/least_squares.h"

namespace palpate::identify {

/// [setup] How the other parameters, shared ones first, then each part's own, go with one, to first order,
/// when they are fitted again: 1 for that one. Each part's own are eliminated before all parts' shared ones
/// are found. @param index as in parameter_of()
[[nodiscard]] Point tangent(const Problem& problem, const Solution& at, std::size_t index);

/// [setup] `at` with one shared parameter (or one of the first part's own) moved by `step`, within the
/// bounds, the others first as the data pull them along, then all fitted again.
[[nodiscard]] Solution moved_along(const Problem& problem, const Solution& at, std::size_t index,
                                   double step);

/// [setup] `at` with a parameter at `value`, all others fitted again, on the way there too, so that a narrow
/// bent valley is not lost. @param value within the bounds
[[nodiscard]] Solution moved_to(const Problem& problem, Solution at, std::size_t index, double value);

/// [any] A parameter of a solution: shared ones first, then the first part's own.
[[nodiscard]] double parameter_of(const Solution& solution, std::size_t index);

/// [setup] Walks one parameter from `from` up or down, all others fitted again, as long as `excess` is at
/// most 1, to about where it is 1.
/// @param excess 0 at the best, growing about as the way from there; infinite where it is not known
/// @param visit gets every solution on the way, and one in between for the end
void walk_valley(const Problem& problem, const Solution& from, std::size_t index, double direction,
                 const std::function<double(const Solution&)>& excess,
                 const std::function<void(const Solution&)>& visit);

/// [setup] The sum of squares of each part, priors included: what cost_of() adds up.
[[nodiscard]] std::vector<double> part_costs(const Problem& problem, const Solution& solution);

/// [setup] Whether specimens that are each one draw of their tissue leave a solution beside the best one: how
/// much worse each is fitted by it, over the specimens, is not more than chance gives. To first order that is
/// the 95 % interval of a mean from the spread of the specimens' own pulls (the sandwich estimate).
/// @param best, other costs of each part
[[nodiscard]] bool specimens_leave(const std::vector<double>& best, const std::vector<double>& other);

}  // namespace palpate::identify
