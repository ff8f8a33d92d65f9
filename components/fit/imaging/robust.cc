#include "fit/imaging/robust.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "core/base/statistics.h"

namespace palpate::imaging {
namespace {

using Weights = std::vector<double>;

struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

Normal normal_equations(std::span<const double> x, std::span<const double> y, int degree,
                        const Weights& weights) {
  Normal normal{Eigen::MatrixXd::Zero(degree + 1, degree + 1), Eigen::VectorXd::Zero(degree + 1)};
  Eigen::VectorXd row(degree + 1);
  for (std::size_t i = 0; i < x.size(); ++i) {
    double power = 1.0;
    for (int k = 0; k <= degree; ++k) {
      row[k] = power;
      power *= x[i];
    }
    normal.matrix.noalias() += weights[i] * row * row.transpose();
    normal.right += weights[i] * y[i] * row;
  }
  normal.matrix.diagonal().array() += 1e-12;  // keeps the matrix regular when points coincide
  return normal;
}

struct Weighted {
  std::vector<double> coefficients;
  Weights weights;
};

Weighted fit_weighted(std::span<const double> x, std::span<const double> y, int degree, double scale) {
  Weighted fit;
  fit.weights.assign(x.size(), 1.0);
  double now = 1e300;
  for (int pass = 0; pass < 12; ++pass) {
    const Normal normal = normal_equations(x, y, degree, fit.weights);
    const Eigen::VectorXd solved = normal.matrix.ldlt().solve(normal.right);
    fit.coefficients.assign(solved.data(), solved.data() + solved.size());
    std::vector<double> residuals(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      residuals[i] = std::abs(y[i] - polynomial_at(fit.coefficients, x[i]));
    }
    now = std::max(scale, std::min(0.6 * now, 3.0 * median(residuals)));
    double change = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double share = residuals[i] / now;
      const double weight = 1.0 / ((1.0 + share * share) * (1.0 + share * share));
      change = std::max(change, std::abs(weight - fit.weights[i]));
      fit.weights[i] = weight;
    }
    if (change < 1e-3) break;
  }
  return fit;
}

}  // namespace

std::vector<double> robust_polynomial(std::span<const double> x, std::span<const double> y, int degree,
                                      double scale) {
  return fit_weighted(x, y, degree, scale).coefficients;
}

double polynomial_at(std::span<const double> coefficients, double x) {
  double value = 0.0;
  for (std::size_t k = coefficients.size(); k-- > 0;) value = value * x + coefficients[k];
  return value;
}

LocalFit local_parabola(std::span<const double> x, std::span<const double> y, double scale) {
  const Weighted fit = fit_weighted(x, y, 2, scale);
  double squares = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - polynomial_at(fit.coefficients, x[i]);
    squares += fit.weights[i] * off * off;
    weight += fit.weights[i];
  }
  LocalFit local;
  local.value = fit.coefficients[0];
  local.slope = fit.coefficients[1];
  local.curvature = 2.0 * fit.coefficients[2] / std::pow(1.0 + local.slope * local.slope, 1.5);
  local.scatter = std::sqrt(squares / std::max(weight - 3.0, 0.5));
  const Normal normal = normal_equations(x, y, 2, fit.weights);
  local.gain = std::sqrt(std::max(0.0, normal.matrix.inverse()(0, 0)));
  return local;
}

}  // namespace palpate::imaging
