#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "io/system/files.h"

namespace palpate {

/// [setup] Creates a file whose existence has a meaning: its name appears together with its whole content, or
/// not at all. The content is written to a temporary file in the same folder and flushed to the disk, the
/// file is linked to its name without replacing another one, and the folder is flushed. A killed process
/// leaves at most a file .NAME. and six random letters.
/// @param mode of the file, less the process's umask @throws InputError naming the file, when it exists or
/// cannot be written; then nothing has the name that had not before
void create_whole_file(const std::filesystem::path& file, std::string_view bytes, mode_t mode = 0644);

/// [setup] The name that a temporary file of create_whole_file() was to get; empty for any other file.
[[nodiscard]] std::string name_of_unfinished(const std::filesystem::path& temporary);

}  // namespace palpate
