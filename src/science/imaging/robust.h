#pragma once
#include <span>
#include <vector>

namespace palpate::imaging {

/// [setup] Coefficients, lowest power first, of the polynomial through points of which many may lie anywhere:
/// least squares weighted again by how far each lies off, (1 + (r/scale)^2)^-2 [Geman and McClure 1987], with
/// a scale that falls from all of the residuals' spread to `scale`, so that the most points win.
/// @param scale what a good point may lie off; as many x as y, more than `degree`
[[nodiscard]] std::vector<double> robust_polynomial(std::span<const double> x, std::span<const double> y,
                                                    int degree, double scale);

/// [any] The polynomial's value.
[[nodiscard]] double polynomial_at(std::span<const double> coefficients, double x);

/// A parabola through neighbours, at x = 0.
struct LocalFit {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;  // of the graph: 1 over the radius
  double scatter = 0.0;    // standard deviation of a point about it
  double gain = 0.0;       // standard deviation of `value` for points that scatter by 1
};

/// [setup] @param scale what a good point may lie off; at least four points
[[nodiscard]] LocalFit local_parabola(std::span<const double> x, std::span<const double> y, double scale);

}  // namespace palpate::imaging
