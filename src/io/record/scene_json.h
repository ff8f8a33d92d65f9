#pragma once
#include <string>

#include "palpate/scene.h"

namespace palpate::record {

/// [setup] A scene as JSON in SI units, without vertices and triangles. Its numbers read back to the same
/// bits.
[[nodiscard]] std::string scene_to_json(const scene::Scene& scene);

/// [setup] The inverse of scene_to_json(). Meshes stay empty. The path of a vendor's library stays empty too:
/// a recording may come from anybody, and must load no code. @throws InputError naming the key that is
/// missing or wrong.
[[nodiscard]] scene::Scene scene_from_json(const std::string& text);

}  // namespace palpate::record
