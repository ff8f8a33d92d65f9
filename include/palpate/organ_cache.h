#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "palpate/preparation.h"

namespace palpate::scene {

/// [setup] The user's cache of prepared organs, which the program uses: $XDG_CACHE_HOME/palpate if that is an
/// absolute path, else $HOME/.cache/palpate; on Windows %LOCALAPPDATA%\palpate. Empty if neither is set or
/// PALPATE_CACHE is "off". The folder need not exist.
[[nodiscard]] std::filesystem::path organ_cache_folder();

/// [setup] Makes `how` read prepared organs from `folder` and write new ones there; an empty path means no
/// cache. Files that cannot be read or written are no error.
/// @param remark called once per organ, for a log: whether the cache had it and, if not, why
/// @param distrusted called immediately, with the reason, when other users own the folder or may write to it;
/// the folder is then not used
void use_organ_cache(contact::Preparation& how, std::filesystem::path folder = organ_cache_folder(),
                     std::function<void(const std::string&)> remark = {},
                     const std::function<void(const std::string&)>& distrusted = {});

}  // namespace palpate::scene
