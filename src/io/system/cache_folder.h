#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "io/system/files.h"

namespace palpate {

/// [setup] The folder for data that palpate can compute again: $XDG_CACHE_HOME/palpate if that is an absolute
/// path, else $HOME/.cache/palpate; on Windows %LOCALAPPDATA%\palpate. Empty if neither is set or
/// PALPATE_CACHE is "off". The folder need not exist.
[[nodiscard]] std::filesystem::path user_cache_folder();

/// [setup] The folder for data that a user may want to examine later: $XDG_STATE_HOME/palpate if that is an
/// absolute path, else $HOME/.local/state/palpate. Empty if neither is set. The folder need not exist.
[[nodiscard]] std::filesystem::path user_state_folder();

/// [setup] The folder of the user's configuration: $XDG_CONFIG_HOME/palpate if that is an absolute path, else
/// $HOME/.config/palpate. Empty if neither is set. The folder need not exist.
[[nodiscard]] std::filesystem::path user_config_folder();

/// [setup] Whether a file or folder belongs to this process's user and no other user may write to it, so that
/// its content can be trusted. @param facts of stat()
[[nodiscard]] bool is_private(const FileStatus& facts) noexcept;

/// [setup] The reason why the content of `folder` cannot be trusted, for a message; empty when it can, or the
/// folder does not exist.
[[nodiscard]] std::string distrust_reason(const std::filesystem::path& folder);

/// [setup] Creates a folder that only this user may read, and its parent folders with usual rights. @return
/// whether it exists and can be trusted
[[nodiscard]] bool make_private_folder(const std::filesystem::path& folder);

/// [setup] Removes files of `folder` whose names end in `ending`, the oldest first, until the rest has at
/// most `max_bytes`. Also removes temporary files (`ending`, a dot and six letters) of writers that were
/// killed over an hour ago. Files that cannot be removed are no error.
void trim_cache(const std::filesystem::path& folder, std::string_view ending, std::uint64_t max_bytes);

}  // namespace palpate
