#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"
#include "tools/make_shapes/vessel_lines.h"

namespace palpate::geometry {

/// [setup] A human liver with a sharp lower margin: 3,502 vertices and 7,000 triangles, or 30,000 or 75,000
/// triangles; closed, metres. The falciform ligament's stump and the notch of the round ligament separate the
/// right and left lobe. The caudate and quadrate lobes are below, around the porta hepatis. Portal vein,
/// hepatic artery and bile duct are cut off. The surface has the empty fossa of the gallbladder, the groove
/// and stump of the inferior vena cava, and the impressions of kidney, colon, stomach and heart. Anterior
/// view from +z with +y up: the left lobe's tip points to +x (the patient's left).
[[nodiscard]] TriangleMesh make_liver(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> liver_vessels();

}  // namespace palpate::geometry
