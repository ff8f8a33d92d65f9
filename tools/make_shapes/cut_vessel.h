#pragma once
#include <vector>

#include "tools/make_shapes/implicit.h"
#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

/// A vessel that has been cut across: flat at its end, with the lumen showing as a pit. In millimetres.
class CutVessel final {
 public:
  static constexpr double kRim = 2.0;  // [mm] rounding of the cut's edge

  /// [setup] Along `knots`, cut at the last one; `far` as a tube's.
  CutVessel(const std::vector<TubeKnot>& knots, double far);

  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;

  /// [setup] The lumen: a bowl sunk into the cut, to be taken out of the whole.
  [[nodiscard]] Ellipsoid lumen() const;

 private:
  Tube tube_;
  TubeKnot end_;
  Vec3 out_;
};

}  // namespace palpate::geometry
