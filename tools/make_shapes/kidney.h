#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"
#include "tools/make_shapes/vessel_lines.h"

namespace palpate::geometry {

/// [setup] A human right kidney with renal artery, renal vein and ureter cut off, and slight foetal lobes:
/// 3,002 vertices and 6,000 triangles, or 30,000 or 75,000 triangles; closed, metres. Anterior view from +z
/// with +y up: the upper pole points to +y, the hilum faces +x (the middle of the body). From front to back
/// the hilum has vein, artery and renal pelvis.
[[nodiscard]] TriangleMesh make_kidney(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> kidney_vessels();

}  // namespace palpate::geometry
