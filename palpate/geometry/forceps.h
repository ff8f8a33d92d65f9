#pragma once
#include "palpate/geometry/tool.h"

namespace palpate::geometry {

/// [setup] Laparoscopic forceps with curved, tapering jaws (as a Maryland dissector): jaws "left" and "right"
/// about 24 mm long, which turn about y at the origin, 15 degrees each, and "shaft", 5 mm thick. +z towards
/// the tips; they bend towards -x. Every part closed. About 461 vertices as in [Zhang 2011, section 3.1].
[[nodiscard]] Tool make_curved_forceps();

/// [setup] The same with straight blunt jaws about 20 mm long whose teeth interlock (atraumatic). About 612
/// vertices as in [Zhang 2011, section 3.1].
[[nodiscard]] Tool make_straight_forceps();

}  // namespace palpate::geometry
