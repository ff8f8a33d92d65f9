#pragma once

namespace palpate::geometry {

/// How finely a built-in shape is meshed: the paper's counts, or about so many triangles.
enum class Detail { kPaper, k30k, k300k };

}  // namespace palpate::geometry
