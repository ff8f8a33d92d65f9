#pragma once

namespace palpate::geometry {

/// Resolution of a built-in mesh: the paper's counts, 30,000 or 75,000 triangles. The library divides each of
/// the 75,000 triangles into four (src/io/shapes/mesh_archive.h).
enum class Detail { kPaper, k30k, k75k };

}  // namespace palpate::geometry
