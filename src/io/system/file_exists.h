#pragma once
#include <filesystem>

// std::filesystem::exists(), with an error code, is false also where the system cannot look: a folder without
// permission, a cycle of links, a name that is too long. The functions here throw in that case. Where an
// error may count as an absent file (a cache), a comment states it (tools/lint_sources).
namespace palpate {

/// [setup] Whether the path leads to a file or folder; links are followed. @throws InputError "PATH: cannot
/// be looked at: WHY"
[[nodiscard]] bool file_exists(const std::filesystem::path& path);

/// [setup] As file_exists(), for a file whose absence has a meaning. @throws InputError also for a link that
/// leads to nothing
[[nodiscard]] bool file_or_link_exists(const std::filesystem::path& path);

/// [setup] Whether the path leads to a regular file. @throws InputError as file_exists()
[[nodiscard]] bool regular_file_exists(const std::filesystem::path& path);

/// [setup] Whether the path leads to a folder. @throws InputError as file_exists()
[[nodiscard]] bool folder_exists(const std::filesystem::path& path);

/// [setup] Whether the path leads to a folder without files, or to nothing. @throws InputError as
/// file_exists(), and when the folder cannot be read
[[nodiscard]] bool is_free_folder(const std::filesystem::path& path);

}  // namespace palpate
