#pragma once
#include <vector>

#include "palpate/mesh.h"
#include "palpate/tool.h"

#include "tools/make_shapes/organs.h"

namespace palpate::geometry {

/// [setup] Forceps with curved, tapering jaws, "left" and "right", about 24 mm long, which rotate about y at
/// the origin by 15 degrees each, and "shaft". +z points to the tips; they bend towards -x. All parts are
/// closed. Detail::kPaper: about 461 vertices as in [Zhang 2011, section 3.1]; the shaft is a plain tube 5 mm
/// thick. Finer: ribbed jaws, box joint, shanks, ratchet and finger rings, 30,000 or 75,000 triangles in
/// total; the shaft does not open with the jaws.
[[nodiscard]] Tool make_curved_forceps(Detail detail);

/// [setup] Forceps with straight, blunt jaws about 20 mm long with interlocking ribs; frame, parts and finer
/// details as for the curved ones. Detail::kPaper: about 612 vertices as in [Zhang 2011, section 3.1].
[[nodiscard]] Tool make_straight_forceps(Detail detail);

/// [setup] A closed surface over closed rings of equally many points: quads (two triangles each) between
/// successive rings, and a fan to a point beyond each end. It is oriented outwards when the rings are
/// counter-clockwise seen from the last one's side.
[[nodiscard]] TriangleMesh loft(const std::vector<std::vector<Vec3>>& rings, const Vec3& first_pole,
                                const Vec3& last_pole);

}  // namespace palpate::geometry
