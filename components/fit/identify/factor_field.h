#pragma once
#include <span>
#include <vector>

#include <Eigen/Core>

#include "palpate/inclusion.h"

namespace palpate::identify {

/// The factor k of a tissue's stiffness over a surface, between points that give it. On a plane ln k is the
/// function with the least
///
///     sum_i (ln k_i - ln k(x_i))^2 / tolerance + integral |grad ln k|^2 + l^2 (Laplacian ln k)^2,   l = 10
///     mm,
///
/// which contact::StiffnessMap computes on an organ's mesh. Its kernel is -(ln(r/l) + K_0(r/l)) / 2 pi.
class FactorField final {
 public:
  /// The factor is 1 everywhere.
  FactorField() = default;
  /// [setup] @param tolerance >= 0, how little the points hold the function; by default as in an organ
  explicit FactorField(std::span<const model::StiffnessPoint> points, double tolerance = kOrganTolerance);

  /// [setup] The factor at a point.
  [[nodiscard]] double at(const Vec3& point) const;
  /// [setup] The factor at point i that the other points alone give.
  [[nodiscard]] double without(std::size_t i) const { return without_[i]; }

  static constexpr double kOrganTolerance = 1e-4;   // the inverse weight of a point in contact::StiffnessMap
  static constexpr std::size_t kMostPoints = 1500;  // of more, as many at even steps are used

 private:
  std::vector<Vec3> points_;
  Eigen::VectorXd weights_;  // of the points' kernels, then the constant
  std::vector<double> without_;
};

}  // namespace palpate::identify
