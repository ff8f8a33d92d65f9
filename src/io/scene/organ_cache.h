#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "core/contact/organ_arrays.h"
#include "io/system/array_file.h"
#include "palpate/preparation.h"

namespace palpate::scene {

/// [setup] Makes `how` read prepared organs from `folder` and write new ones there; an empty path means no
/// cache. Files that cannot be read or written are no error.
/// @param remark called once per organ, for a log: whether the cache had it and, if not, why
/// @param distrusted called immediately, with the reason, when other users own the folder or may write to it;
/// the folder is then not used
void use_organ_cache(contact::Preparation& how, std::filesystem::path folder,
                     std::function<void(const std::string&)> remark = {},
                     const std::function<void(const std::string&)>& distrusted = {});

/// [setup] Writes all arrays except the face normals: computing those is faster than reading them.
void put(const contact::OrganArrays& arrays, ArrayFileWriter& file);
/// [setup] Reads the arrays that put() wrote; empty when one is missing or an index is out of range.
[[nodiscard]] std::optional<contact::OrganArrays> get(const ArrayFileReader& file);

}  // namespace palpate::scene
