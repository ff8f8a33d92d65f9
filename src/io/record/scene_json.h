#pragma once
#include <string>

#include "palpate/scene.h"

namespace palpate::record {

/// [setup] A scene as JSON, SI, numbers in a form that reads back to the same bits; without the meshes'
/// vertices and triangles.
[[nodiscard]] std::string setup_to_json(const scene::Setup& setup);

/// [setup] The inverse; meshes are left empty, and so is the path of a vendor's library: a recording may come
/// from anybody, and whatever is run from it must load no code. @throws InputError naming the key that is
/// missing or wrong.
[[nodiscard]] scene::Setup setup_from_json(const std::string& text);

}  // namespace palpate::record
