#pragma once
#include <cstddef>
#include <vector>

namespace palpate::validate {

/// A patch of masses and springs as simulators of surgery commonly use it for a surface: a square grid of
/// nodes that move along the normal, springs to the eight neighbours with their length at rest, a spring from
/// every node to its place at rest (home spring), a rim that stands still. The middle node goes with the
/// tool; the others come to rest by relaxation: a fixed number of sweeps over the grid from where they were.
/// For comparison only; one thread.
class MassSpringPatch final {
 public:
  static constexpr std::size_t kSide = 11;  // nodes
  static constexpr double kSpacing = 4e-3;  // m
  static constexpr int kSweeps = 60;        // each evaluation
  static constexpr std::size_t kMiddle = kSide / 2;

  /// [setup] @param ratio stiffness of a spring between neighbours over that of a home spring, >= 0
  explicit MassSpringPatch(double ratio);

  /// [any] Moves the middle node to `depth` [m] and the others towards rest; allocates nothing.
  /// @return force on the tool over the stiffness of a home spring [m]
  double press(double depth) noexcept;

  /// [any] Displacement [m] at distance r [m] along a row of the grid, linear between nodes; 0 past the rim.
  [[nodiscard]] double at(double r) const noexcept;

 private:
  [[nodiscard]] double& node(std::size_t row, std::size_t column) noexcept {
    return down_[row * kSide + column];
  }
  /// Of the eight springs, along the normal, over the stiffness of a home spring.
  struct Pull {
    double force = 0.0;      // m
    double stiffness = 0.0;  // its fall as the node goes down
  };
  [[nodiscard]] Pull pull_of_neighbours(std::size_t row, std::size_t column) const noexcept;

  double ratio_;
  std::vector<double> down_;  // m
};

}  // namespace palpate::validate
