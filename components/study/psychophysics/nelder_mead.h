#pragma once
#include <functional>
#include <vector>

namespace palpate::psychophysics {

struct Minimum {
  std::vector<double> at;
  double value = 0.0;
};

/// [setup] A local minimum by the simplex method [Nelder and Mead 1965], restarted once at its result.
/// @param cost may return infinity @param start with a finite cost
/// @param steps initial edges, one for each coordinate, not 0
/// @param tolerance largest difference of the costs of the last simplex
[[nodiscard]] Minimum minimize(const std::function<double(const std::vector<double>&)>& cost,
                               const std::vector<double>& start, const std::vector<double>& steps,
                               double tolerance = 1e-9);

}  // namespace palpate::psychophysics
