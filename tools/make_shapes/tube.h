#pragma once
#include <array>
#include <vector>

#include "tools/make_shapes/implicit.h"

namespace palpate::geometry {

/// A point of a tube's centre line, with the tube's radius.
struct TubeKnot {
  Vec3 middle = Vec3::Zero();  // [m]
  double radius = 0.0;         // [m]
};

/// A round tube along a smooth curve through its knots, with rounded ends.
class Tube final {
 public:
  /// [setup] Natural cubic spline of position and radius through at least two knots, so that the tube's
  /// curvature is continuous. Farther than `far` from the tube's bounding box at() returns only a lower
  /// bound: `far` [m] must be at least the widest blend with other solids.
  Tube(const std::vector<TubeKnot>& knots, double far);

  /// The distance to the nearest of the balls that fill the tube, in the unit of the knots.
  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;
  /// The centre line at a fraction 0..1 of its knots.
  [[nodiscard]] TubeKnot knot_at(double share) const noexcept;
  /// Unit direction of the centre line at its end, outwards.
  [[nodiscard]] Vec3 end_direction() const noexcept;
  [[nodiscard]] const TubeKnot& end() const noexcept { return end_; }

 private:
  using Four = std::array<double, 4>;  // x, y, z, radius
  struct Span {                        // value = a + u (b + u (c + u d)), u 0..1
    Four a{}, b{}, c{}, d{};
  };
  struct Piece {  // straight piece of the centre line, for a rough nearest point
    std::array<double, 3> start{};
    std::array<double, 3> along{};
    double length2 = 0.0;
    double radius = 0.0;  // at its start
    double taper = 0.0;   // radius at its end minus radius
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
  Bounds box_;  // bounding box of the tube
  double far_;
};

}  // namespace palpate::geometry
