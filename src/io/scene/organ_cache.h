#pragma once
#include <optional>

#include "core/contact/organ_arrays.h"
#include "io/system/array_file.h"

namespace palpate::scene {

/// [setup] Writes all arrays except the face normals: computing those is faster than reading them.
void put(const contact::OrganArrays& arrays, ArrayFileWriter& file);
/// [setup] Reads the arrays that put() wrote; empty when one is missing or an index is out of range.
[[nodiscard]] std::optional<contact::OrganArrays> get(const ArrayFileReader& file);

}  // namespace palpate::scene
