#pragma once
#include <cstddef>
#include <vector>

namespace palpate::validate {

/// Mass-spring surface patch as used in surgery simulators, for comparison. It is a square grid of nodes that
/// move along the normal, with a fixed rim. Each node has springs to its eight neighbours and a spring to its
/// rest position (home spring); no spring has force at rest. The middle node follows the tool; the others are
/// relaxed by a fixed number of sweeps from their previous positions. Single-threaded.
class MassSpringPatch final {
 public:
  static constexpr std::size_t kSide = 11;  // nodes per side
  static constexpr double kSpacing = 4e-3;  // m
  static constexpr int kSweeps = 60;        // per evaluation
  static constexpr std::size_t kMiddle = kSide / 2;

  /// [setup] @param ratio stiffness of a spring between neighbours / stiffness of a home spring, >= 0
  explicit MassSpringPatch(double ratio);

  /// [any] Moves the middle node to `depth` [m] and relaxes the others; allocates nothing. @return force on
  /// the tool divided by the stiffness of a home spring [m]
  double press(double depth) noexcept;

  /// [any] Displacement [m] at distance r [m] along a row of the grid, linear between nodes; 0 beyond the
  /// rim.
  [[nodiscard]] double at(double r) const noexcept;

 private:
  [[nodiscard]] double& node(std::size_t row, std::size_t column) noexcept {
    return down_[row * kSide + column];
  }
  /// Normal force of the eight springs and its derivative, divided by the stiffness of a home spring.
  struct Pull {
    double force = 0.0;      // m
    double stiffness = 0.0;  // decrease of the force per displacement of the node
  };
  [[nodiscard]] Pull pull_of_neighbours(std::size_t row, std::size_t column) const noexcept;

  double ratio_;
  std::vector<double> down_;  // m, displacement of each node
};

}  // namespace palpate::validate
