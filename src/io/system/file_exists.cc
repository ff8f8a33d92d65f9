#include "io/system/file_exists.h"

#include <system_error>

#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::error_code& why) {
  throw InputError(to_text(path) + ": cannot be looked at: " + why.message());
}

/// The type of file that a path leads to; not_found for ENOENT and ENOTDIR.
fs::file_type type_of(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::none) fail(path, error);
  return type;
}

}  // namespace

bool file_exists(const fs::path& path) { return type_of(path) != fs::file_type::not_found; }

bool file_or_link_exists(const fs::path& path) {
  if (file_exists(path)) return true;
  std::error_code absent;
  if (fs::symlink_status(path, absent).type() != fs::file_type::symlink) return false;
  throw InputError(to_text(path) + ": is a link that leads to nothing, must be a file or absent");
}

bool regular_file_exists(const fs::path& path) { return type_of(path) == fs::file_type::regular; }

bool folder_exists(const fs::path& path) { return type_of(path) == fs::file_type::directory; }

bool is_free_folder(const fs::path& path) {
  const fs::file_type type = type_of(path);
  if (type != fs::file_type::directory) return type == fs::file_type::not_found;
  std::error_code error;
  const bool empty = fs::is_empty(path, error);
  if (error) fail(path, error);
  return empty;
}

}  // namespace palpate
