#pragma once
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/tool.h"

namespace palpate::geometry {

/// [setup] Names of the built-in organs: "gallbladder", "heart", "liver", "kidney", "ball", "box". The first
/// four also exist with the suffix "-30k" or "-300k", which is the number of triangles.
[[nodiscard]] const std::vector<std::string>& builtin_organ_names();

/// [setup] A built-in organ in metres, with the centre of its bounding box at the origin. @throws InputError
/// that lists the names.
[[nodiscard]] TriangleMesh make_organ(const std::string& name);

/// [setup] Names of the built-in instruments: "curved-forceps" and "straight-forceps" (two jaws each), which
/// also exist with the suffix "-30k" or "-300k", the number of triangles; and "needle" (18G, 90 mm, bevel).
/// The list omits the ball tools "sphere:R" (R in mm) and other needles "needle:SIZE,LENGTH_MM,TIP" (SIZE a
/// gauge such as 18G or mm; TIP bevel, pencil or tuohy), which make_tool() accepts too.
[[nodiscard]] const std::vector<std::string>& builtin_tool_names();

/// [setup] A built-in instrument in its handle frame (origin at the jaw pivot, +z towards the tips). @throws
/// InputError that lists the names.
[[nodiscard]] Tool make_tool(const std::string& name);

}  // namespace palpate::geometry
