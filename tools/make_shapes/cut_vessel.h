#pragma once
#include <vector>

#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

/// A vessel that was cut across: a flat end with the lumen as a pit. In millimetres.
class CutVessel final {
 public:
  static constexpr double kRim = 2.0;  // [mm] rounding radius of the cut's edge

  /// [setup] A vessel along `knots`, cut at the last one; `far` as for Tube.
  CutVessel(const std::vector<TubeKnot>& knots, double far);

  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;
  [[nodiscard]] const Tube& tube() const noexcept { return tube_; }

  /// [setup] The lumen: an ellipsoid at the cut, to be subtracted from the solid.
  [[nodiscard]] Ellipsoid lumen() const;

 private:
  Tube tube_;
  TubeKnot end_;
  Vec3 out_;
};

}  // namespace palpate::geometry
