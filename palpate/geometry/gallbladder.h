#pragma once
#include "palpate/geometry/mesh.h"

namespace palpate::geometry {

/// [setup] A human gallbladder with its cystic duct cut off: 1,057 vertices, 2,110 triangles, closed, metres.
/// Long axis along x (fundus at -x), the body's broad side up (+z).
[[nodiscard]] TriangleMesh make_gallbladder();

}  // namespace palpate::geometry
