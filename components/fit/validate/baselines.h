#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/validate.h"

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

/// Baseline models, for comparison.
enum class BaselineKind {
  kHertz,        // F = a d^1.5; surface of a half-space around a ball with a fitted contact radius
  kLinear,       // F = a d; profile: a cone
  kExponential,  // F = a (e^(b d) - 1); profile: u = D e^(-r/b)
  kMassSpring,   // MassSpringPatch with its two stiffnesses fitted (profile: their ratio)
};

/// [any] "hertz", "linear", "exponential", "mass-spring".
[[nodiscard]] const char* to_string(BaselineKind kind) noexcept;
/// [setup] Parses a comma-separated list of kinds, each once. @throws InputError that names the invalid one
/// and all valid ones.
[[nodiscard]] std::vector<BaselineKind> parse_baselines(std::string_view text);

/// [any] Displacement of the surface of an elastic half-space under a ball, at distance r >= 0 from the axis
/// [Johnson 1985, eq. 3.41a and 3.42a]. Lengths in m. @param contact_radius > 0
[[nodiscard]] double hertz_displacement(double depth, double contact_radius, double r) noexcept;

/// A baseline model fitted to one data set by least squares.
struct BaselineFit {
  BaselineKind kind = BaselineKind::kHertz;
  std::string parameters;                  // formatted for output
  Errors errors;                           // on the same scale as those of the law
  std::vector<double> computed;            // N, or m for a profile
  std::function<double(double)> evaluate;  // force [N] at a depth [m], or u [m] at r [m]; not empty; for a
                                           // mass-spring patch one relaxation of all nodes
};

/// [setup] Fits the compared force curve: depths and forces with the zeros subtracted. Baseline models have
/// no relaxation.
[[nodiscard]] BaselineFit fit_force_baseline(BaselineKind kind, const ForceComparison& comparison);

/// [setup] Fits the compared profile; the depth is given.
[[nodiscard]] BaselineFit fit_profile_baseline(BaselineKind kind, const DeformationComparison& comparison);

}  // namespace palpate::validate
