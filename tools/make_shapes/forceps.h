#pragma once
#include "palpate/tool.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// [setup] Forceps with curved, tapering jaws, "left" and "right", about 24 mm long, which turn about y at
/// the origin, 15 degrees each, and "shaft". +z towards the tips; they bend towards -x. Every part closed.
/// Detail::kPaper: about 461 vertices as in [Zhang 2011, section 3.1], the shaft a plain tube 5 mm thick, for
/// which alone the count suffices. Finer: ribbed jaws, box joint, shanks, ratchet and finger rings, 30,000 or
/// 75,000 triangles in all; the shaft does not open with the jaws.
[[nodiscard]] Tool make_curved_forceps(Detail detail);

/// [setup] The same with straight blunt jaws about 20 mm long whose ribs interlock. Detail::kPaper: about 612
/// vertices as in [Zhang 2011, section 3.1].
[[nodiscard]] Tool make_straight_forceps(Detail detail);

}  // namespace palpate::geometry
