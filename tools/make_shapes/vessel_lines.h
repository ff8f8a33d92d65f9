#pragma once
#include <string>
#include <vector>

#include "tools/make_shapes/tube.h"

namespace palpate::geometry {

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
