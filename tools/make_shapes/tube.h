#pragma once
#include <array>
#include <vector>

#include "tools/make_shapes/implicit.h"

namespace palpate::geometry {

/// A point of a tube's centre line and the tube's radius there.
struct TubeKnot {
  Vec3 middle = Vec3::Zero();  // [m]
  double radius = 0.0;         // [m]
};

/// A round tube along a smooth curve through its knots, ends rounded.
class Tube final {
 public:
  /// [setup] Natural cubic spline through at least two knots, place and radius alike, so that the tube's
  /// curvature has no steps. Farther than `far` from the box around the tube at() gives a lower bound only:
  /// `far` [m] must be at least the widest blend with other solids.
  Tube(const std::vector<TubeKnot>& knots, double far);

  /// The distance to the nearest of the balls that fill the tube, [m] with knots in metres.
  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;
  /// The centre line at a share 0..1 of its knots.
  [[nodiscard]] TubeKnot knot_at(double share) const noexcept;
  /// Unit direction of the centre line at its end, outwards.
  [[nodiscard]] Vec3 end_direction() const noexcept;
  [[nodiscard]] const TubeKnot& end() const noexcept { return end_; }

 private:
  using Four = std::array<double, 4>;  // x, y, z, radius
  struct Span {                        // value = a + u (b + u (c + u d)), u 0..1
    Four a{}, b{}, c{}, d{};
  };
  struct Piece {  // of the centre line, straight, to find the nearest place roughly
    std::array<double, 3> start{};
    std::array<double, 3> along{};
    double length2 = 0.0;
    double radius = 0.0;  // at its start
    double taper = 0.0;   // what its end has more
  };
  struct Jet {
    Four value{}, first{}, second{};
  };

  void fit(const std::vector<TubeKnot>& knots);
  void divide();
  [[nodiscard]] Jet jet(double u) const noexcept;
  [[nodiscard]] double rough_place(const Vec3& p) const noexcept;

  std::vector<Span> spans_;
  std::vector<Piece> pieces_;
  TubeKnot end_;
  Bounds box_;  // around everything
  double far_;
};

}  // namespace palpate::geometry
