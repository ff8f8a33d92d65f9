#pragma once
#include <filesystem>
#include <string>

#include "palpate/model/tissue.h"

namespace palpate::scene {

/// [setup] Reads and checks a tissue file. @throws InputError: one line, FILE:LINE: field = value: what would
/// be right; unknown keys too, with the nearest known one.
[[nodiscard]] model::TissueParameters read_tissue_file(const std::filesystem::path& file);

/// [setup] The text of a tissue file that reads back to the same parameters (lengths within one rounding of
/// their last digit).
[[nodiscard]] std::string to_toml(const model::TissueParameters& tissue);

}  // namespace palpate::scene
