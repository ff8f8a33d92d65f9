#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"
#include "tools/make_shapes/vessel_lines.h"

namespace palpate::geometry {

/// [setup] A human heart with its great vessels cut off: 3,208 vertices and 6,412 triangles, or 30,000 or
/// 75,000 triangles with all coronary vessels; closed, metres. Anterior view from +z with +y up: the front
/// wall of the ventricles faces +z, the apex points to +x and -y (the patient's left), the vessels leave
/// towards +y.
[[nodiscard]] TriangleMesh make_heart(Detail detail);

/// [setup] Its vessels, in the frame of the mesh before that is centred.
[[nodiscard]] std::vector<VesselLine> heart_vessels();

}  // namespace palpate::geometry
