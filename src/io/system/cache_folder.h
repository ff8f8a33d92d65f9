#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/stat.h>

namespace palpate {

/// [setup] Where palpate may keep what it can work out again: $XDG_CACHE_HOME/palpate if that is an absolute
/// path, else $HOME/.cache/palpate; empty without either, and when the environment says PALPATE_CACHE=off.
/// The folder need not be there yet.
[[nodiscard]] std::filesystem::path user_cache_folder();

/// [setup] Where palpate keeps what a user may want to look at later: $XDG_STATE_HOME/palpate if that is an
/// absolute path, else $HOME/.local/state/palpate; empty without either. The folder need not be there yet.
[[nodiscard]] std::filesystem::path user_state_folder();

/// [setup] Where users keep what they set up for palpate: $XDG_CONFIG_HOME/palpate if that is an absolute
/// path, else $HOME/.config/palpate; empty without either. The folder need not be there.
[[nodiscard]] std::filesystem::path user_config_folder();

/// [setup] Whether a file or folder belongs to the user of this process and no other user may write to it, so
/// that what is in it can be believed. @param facts of stat()
[[nodiscard]] bool is_own(const struct stat& facts) noexcept;

/// [setup] Why what is in `folder` cannot be believed, in words; empty when it can, or the folder is not
/// there.
[[nodiscard]] std::string why_not_trusted(const std::filesystem::path& folder);

/// [setup] Makes a folder that only this user may look into, and those around it as usual. @return whether it
/// is there now, and can be trusted
[[nodiscard]] bool make_own_folder(const std::filesystem::path& folder);

/// [setup] Removes the files of `folder` whose names end in `ending`, those longest not written or touched
/// first, until the rest takes at most `most_bytes`; and what writers left that were killed over an hour ago
/// (`ending` and six more letters). What cannot be removed stays; no error.
void trim_cache(const std::filesystem::path& folder, std::string_view ending, std::uint64_t most_bytes);

}  // namespace palpate
