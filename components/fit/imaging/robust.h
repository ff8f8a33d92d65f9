#pragma once
#include <span>
#include <vector>

namespace palpate::imaging {

/// [setup] Robust polynomial fit, for data of which many points may be outliers. Iteratively reweighted least
/// squares with weights (1 + (r/scale)^2)^-2 [Geman and McClure 1987]; the scale decreases from the spread of
/// all residuals to `scale`.
/// @param scale deviation of a good point @param x, y of equal size, more than `degree` points @return
/// coefficients, lowest power first
[[nodiscard]] std::vector<double> robust_polynomial(std::span<const double> x, std::span<const double> y,
                                                    int degree, double scale);

/// [any] Value of the polynomial.
[[nodiscard]] double polynomial_at(std::span<const double> coefficients, double x);

/// A parabola fitted to neighbours, evaluated at x = 0.
struct LocalFit {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;  // 1 / radius of curvature of the graph
  double scatter = 0.0;    // standard deviation of the points about the parabola
  double gain = 0.0;       // standard deviation of `value` for points that scatter by 1
};

/// [setup] @param scale deviation of a good point; needs at least four points
[[nodiscard]] LocalFit local_parabola(std::span<const double> x, std::span<const double> y, double scale);

}  // namespace palpate::imaging
