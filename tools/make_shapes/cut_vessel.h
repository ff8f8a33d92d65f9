#pragma once
#include <string>
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

/// The centre line of a vessel on an organ, for its colour in pictures. In millimetres.
struct VesselLine {
  std::string kind;  // coronary: on the surface; artery, vein, duct: leaves the organ
  std::vector<TubeKnot> knots;
};

/// [setup] `pieces` + 1 knots along a tube.
[[nodiscard]] inline VesselLine line_of(const std::string& kind, const Tube& tube, int pieces) {
  VesselLine line{kind, {}};
  for (int i = 0; i <= pieces; ++i)
    line.knots.push_back(tube.knot_at(static_cast<double>(i) / static_cast<double>(pieces)));
  return line;
}

}  // namespace palpate::geometry
