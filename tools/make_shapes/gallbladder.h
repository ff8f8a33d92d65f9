#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// [setup] A human gallbladder with fundus, body, Hartmann's pouch, curved neck and cystic duct, this with
/// its spiral fold and cut off: 1,057 vertices and 2,110 triangles, or 30,000 or 75,000 triangles; closed,
/// metres. Long axis along x (fundus at -x), the body's broad side up (+z).
[[nodiscard]] TriangleMesh make_gallbladder(Detail detail);

}  // namespace palpate::geometry
