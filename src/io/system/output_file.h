#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// A file, and the flag, argument or line of a scene that names it.
struct NamedFile {
  std::string flag;
  std::filesystem::path path;  // empty: not asked for
};

/// [setup] Makes sure that no output is one of the inputs, or another output: the same file by another name,
/// a hard or a symbolic link counts. Devices and FIFOs may be named twice. Touches nothing.
/// @throws InputError naming both flags.
void refuse_overwriting(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs);

/// [setup] The file that a program changes which writes to `file`: symbolic links are followed, also to a
/// file that is not there yet. @throws InputError when the links go in a circle.
[[nodiscard]] std::filesystem::path link_target(const std::filesystem::path& file);

/// [setup] Whether a file is there that is no regular one: a device, a FIFO. Follows links.
[[nodiscard]] bool is_special_file(const std::filesystem::path& file);

/// [setup] Whether further files may be made beside an output: not beside a device or a FIFO, nor beside
/// /dev/stdout, which may lead to a regular file.
[[nodiscard]] bool may_have_files_beside(const std::filesystem::path& file);

/// [setup] For outputs that are written with jumps, or renamed to their name. @param flag "" or begins the
/// error
/// @throws InputError when is_special_file().
void require_regular_output(const std::filesystem::path& file, const std::string& flag = {});

/// [setup] Writes `bytes` as the whole of `file`, straight to a device or a FIFO.
/// @throws InputError "FLAG FILE: cannot be written: WHY".
void write_output(const std::filesystem::path& file, std::string_view bytes, const std::string& flag = {});

}  // namespace palpate
