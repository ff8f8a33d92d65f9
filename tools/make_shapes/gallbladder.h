#pragma once
#include "palpate/mesh.h"

#include "tools/make_shapes/detail.h"

namespace palpate::geometry {

/// [setup] A human gallbladder with fundus, body, Hartmann's pouch, curved neck and cystic duct, which has
/// its spiral fold and is cut off: 1,057 vertices and 2,110 triangles, or 30,000 or 75,000 triangles; closed,
/// metres. The long axis is x (fundus at -x), the broad side of the body faces +z.
[[nodiscard]] TriangleMesh make_gallbladder(Detail detail);

}  // namespace palpate::geometry
