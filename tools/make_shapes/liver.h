#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// [setup] A human liver: right and left lobe with the falciform ligament's stump between them and the notch
/// of the round ligament, below caudate and quadrate lobe about the porta hepatis with portal vein, hepatic
/// artery and bile duct cut off, the gallbladder's fossa (empty), the groove and stump of the inferior vena
/// cava, what kidney, colon and stomach impress, and on the dome the heart's dent; a sharp lower margin.
/// 3,502 vertices and 7,000 triangles, or 30,000 or 75,000 triangles; closed, metres. Seen as in an anterior
/// view from +z with +y up: the left lobe's tip points to +x (the patient's left).
[[nodiscard]] TriangleMesh make_liver(Detail detail);

}  // namespace palpate::geometry
