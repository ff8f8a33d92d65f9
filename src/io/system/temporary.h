#pragma once
#include <filesystem>
#include <string>

namespace palpate {

/// [setup] Makes a file that nobody else has and opens it for reading and writing.
/// @param path how its name begins; becomes the whole name
/// @return the descriptor, which other programs do not inherit; -1 when it cannot be made, `path` as it was
[[nodiscard]] int open_temporary_file(std::string& path);

/// [setup] Makes a folder that nobody else has. @param path how its name begins
/// @return its whole name; empty when it cannot be made
[[nodiscard]] std::filesystem::path make_temporary_folder(const std::filesystem::path& path);

}  // namespace palpate
