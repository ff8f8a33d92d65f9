#include "fit/identify/factor_field.h"

#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace palpate::identify {
namespace {

constexpr double kPlateLength = 10e-3;  // m, l of contact::StiffnessMap

double plate_kernel(double distance) {
  const double ratio = distance / kPlateLength;
  constexpr double kNear = 1e-6;  // below, the limit: ln 2 minus Euler's constant
  const double sum = ratio < kNear ? std::numbers::ln2 - std::numbers::egamma
                                   : std::log(ratio) + std::cyl_bessel_k(0.0, ratio);
  return -sum / (2.0 * std::numbers::pi);
}

}  // namespace

FactorField::FactorField(std::span<const model::StiffnessPoint> points, double tolerance) {
  if (points.empty()) return;
  const std::size_t step = (points.size() + kMostPoints - 1) / kMostPoints;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i < points.size(); i += step) {
    points_.push_back(points[i].point_S);
    logarithms.push_back(std::log(points[i].factor));
  }
  const auto n = static_cast<Eigen::Index>(points_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(n + 1, n + 1);  // the last row: the weights' sum is 0
  matrix(n, n) = 0.0;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    right[i] = logarithms[row];
    for (Eigen::Index j = 0; j <= i; ++j) {
      matrix(i, j) = plate_kernel((points_[row] - points_[static_cast<std::size_t>(j)]).norm());
      matrix(j, i) = matrix(i, j);
    }
    matrix(i, i) += tolerance;
  }
  const Eigen::MatrixXd inverse = matrix.partialPivLu().inverse();
  weights_ = inverse * right;
  for (Eigen::Index i = 0; i < n; ++i) without_.push_back(std::exp(right[i] - weights_[i] / inverse(i, i)));
}

double FactorField::at(const Vec3& point) const {
  if (points_.empty()) return 1.0;
  double logarithm = weights_[weights_.size() - 1];
  for (std::size_t i = 0; i < points_.size(); ++i) {
    logarithm += weights_[static_cast<Eigen::Index>(i)] * plate_kernel((point - points_[i]).norm());
  }
  return std::exp(logarithm);
}

}  // namespace palpate::identify
