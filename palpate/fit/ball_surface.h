#pragma once
#include "palpate/deform/displacement.h"
#include "palpate/model/tissue.h"

namespace palpate::fit {

/// Which surface under a ball is meant.
struct SurfaceRule {
  /// False: u(r) of model.md, section 3, R_1 at most the ball's radius. True: as the picture shows it, R_1
  /// without a bound, and nowhere above the ball itself.
  bool as_drawn = false;
  /// Of the surface at rest, bulging towards the ball [m]; 0: flat. Past a quarter turn it faces away from
  /// the ball and u(r) alone holds.
  double rest_radius = 0.0;
};

/// How far the surface moves around a ball that is pressed into it.
class BallSurface final {
 public:
  /// [any] @param depth D [m]; <= 0: nothing moves @param radius R of the ball [m]
  BallSurface(const model::ReachParameters& reach, double depth, double radius,
              const SurfaceRule& rule) noexcept;

  /// [rt] Displacement [m] at distance r [m] along the surface; at(0) is D.
  [[nodiscard]] double at(double r) const noexcept;

 private:
  deform::SurfaceProfile profile_;
  double depth_;
  double radius_;
  SurfaceRule rule_;
};

}  // namespace palpate::fit
