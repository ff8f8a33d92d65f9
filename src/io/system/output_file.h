#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// A file, and the flag, argument or line of a scene that names it.
struct NamedFile {
  std::string flag;
  std::filesystem::path path;  // empty: no file
};

/// [setup] Checks that no output is one of the inputs or another output, also through a hard or symbolic
/// link. Devices and FIFOs may be repeated. Changes no file. @throws InputError naming both flags.
void require_no_overwrite(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs);

/// [setup] The file that a program changes when it writes to `file`: symbolic links are followed, also to a
/// file that does not exist yet. @throws InputError when the links form a cycle.
[[nodiscard]] std::filesystem::path link_target(const std::filesystem::path& file);

/// [setup] Whether the file exists and is not regular, e.g. a device or a FIFO. Follows links.
[[nodiscard]] bool is_special_file(const std::filesystem::path& file);

/// [setup] Whether further files may be created next to an output: not for a device or a FIFO, nor for
/// /dev/stdout, which may lead to a regular file.
[[nodiscard]] bool may_have_files_beside(const std::filesystem::path& file);

/// [setup] For outputs that need seeking or a rename. @param flag start of the error message, or "" @throws
/// InputError when is_special_file().
void require_regular_output(const std::filesystem::path& file, const std::string& flag = {});

/// [setup] Writes `bytes` as the content of `file`; a device or a FIFO gets them directly. @throws InputError
/// "FLAG FILE: cannot be written: WHY".
void write_output(const std::filesystem::path& file, std::string_view bytes, const std::string& flag = {});

/// [setup] Replaces `file`, also where it is a link or a device, by a new file that `write` fills under the
/// temporary name that it gets. `file` stays as it was when `write` throws. @throws InputError "FILE: cannot
/// be written: WHY".
void replace_file(const std::filesystem::path& file,
                  const std::function<void(const std::filesystem::path&)>& write);

}  // namespace palpate
