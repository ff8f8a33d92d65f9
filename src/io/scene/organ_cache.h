#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "core/contact/organ_arrays.h"
#include "io/system/array_file.h"
#include "palpate/preparation.h"

namespace palpate::scene {

/// [setup] Lets `how` take prepared organs from files of this folder, and keep them there; empty: no cache. A
/// folder or file that cannot be read or written is no error. @param remark called once an organ with whether
/// the cache had it and, if not, why; for a log @param distrusted called at once with the reason when the
/// folder is not used because other users own it or may write to it
void use_organ_cache(contact::Preparation& how, std::filesystem::path folder,
                     std::function<void(const std::string&)> remark = {},
                     const std::function<void(const std::string&)>& distrusted = {});

/// [setup] Writes everything but the face normals, which are quicker to compute than to read.
void put(const contact::OrganArrays& arrays, ArrayFileWriter& file);
/// [setup] What put() wrote; nothing if an array is missing or an index leads outside.
[[nodiscard]] std::optional<contact::OrganArrays> get(const ArrayFileReader& file);

}  // namespace palpate::scene
