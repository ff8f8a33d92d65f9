#pragma once
#include "palpate/tool.h"

#include "tools/make_shapes/organs.h"

namespace palpate::geometry {

/// Parameters of a pair of haemostatic forceps [mm].
struct HaemostatShape {
  double straight = 100.0;    // straight length of the jaws, from the pivot
  double bend = 0.0;          // curvature of the jaws' centre line after that [1/mm]
  double jaw_length = 20.0;   // along the centre line, from the pivot to the centre of the rounded tip
  double base_radius = 2.2;   // of the closed jaws in front of the joint
  double tip_radius = 2.0;    // of the closed jaws at their tip
  double rib_pitch = 1.2;     // of the ribs across the flats
  double rib_height = 0.2;    // amplitude, half the height from crest to trough
  double open_angle = 0.262;  // [rad] of each jaw at gripper 1
};

/// [setup] Forceps with box joint, shanks, ratchet and finger rings, about 135 mm long, with about 30,000 or
/// 75,000 triangles: jaws "left" and "right", which rotate about y at the origin, and "shaft", the rest.
/// Handle frame as in forceps.h. All parts are closed; the shaft has two handles in the sense of topology
/// (its rings). @param detail not kPaper
[[nodiscard]] Tool make_haemostat(const HaemostatShape& shape, Detail detail);

}  // namespace palpate::geometry
