#pragma once
#include "palpate/geometry/mesh.h"

namespace palpate::geometry {

/// [setup] A human heart with its great vessels cut off: 3,208 vertices, 6,412 triangles, closed, metres.
/// Seen as in an anterior view from +z with +y up: the ventricles' front wall faces
/// +z, the apex points to +x and -y (the patient's left), the vessels leave towards +y.
[[nodiscard]] TriangleMesh make_heart();

}  // namespace palpate::geometry
