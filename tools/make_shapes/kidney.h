#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// [setup] A human right kidney with renal artery, renal vein and ureter cut off, and a trace of its foetal
/// lobes: 3,002 vertices and 6,000 triangles, or 30,000 or 75,000 triangles; closed, metres.
/// Seen as in an anterior view from +z with +y up: the upper pole points to +y, the hilum faces +x (the
/// middle of the body), in it from the front to the back vein, artery and renal pelvis.
[[nodiscard]] TriangleMesh make_kidney(Detail detail);

}  // namespace palpate::geometry
