#pragma once
#include "palpate/tool.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// What tells one pair of haemostatic forceps from another [mm].
struct HaemostatShape {
  double straight = 100.0;    // jaws' length before their bend, from the pivot
  double bend = 0.0;          // curvature of the jaws' centre line after it [1/mm]
  double jaw_length = 20.0;   // along the centre line, from the pivot to the middle of the rounded tip
  double base_radius = 2.2;   // of the closed jaws just ahead of the joint
  double tip_radius = 2.0;    // of the closed jaws at their tip
  double rib_pitch = 1.2;     // of the ribs across the jaws' flats
  double rib_height = 0.2;    // half of it from crest to trough
  double open_angle = 0.262;  // [rad] each jaw at gripper 1
};

/// [setup] Forceps with box joint, shanks, ratchet and finger rings, some 135 mm long, about 30 k or 75 k
/// triangles: jaws "left" and "right", which turn about y at the origin, and "shaft", all the rest. Handle
/// frame as in forceps.h. Every part closed; the shaft has two handles (its rings).
/// @param detail not kPaper
[[nodiscard]] Tool make_haemostat(const HaemostatShape& shape, Detail detail);

}  // namespace palpate::geometry
