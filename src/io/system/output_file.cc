#include "io/system/output_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string shown(const NamedFile& file) {
  return (file.flag.empty() ? "" : file.flag + " ") + to_text(file.path);
}

/// The absolute path without links; the file need not exist.
fs::path plain_path(const fs::path& file) {
  std::error_code error;
  const fs::path plain = fs::weakly_canonical(link_target(file), error);
  return error ? file.lexically_normal() : plain;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  const bool one_there = file_exists(a);
  if (one_there != file_exists(b)) return false;
  if (!one_there) return plain_path(a) == plain_path(b);
  std::error_code error;
  return regular_file_exists(a) && fs::equivalent(a, b, error);
}

}  // namespace

void require_no_overwrite(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].path.empty()) continue;
    for (const NamedFile& input : inputs) {
      if (input.path.empty() || !is_same_file(outputs[i].path, input.path)) continue;
      throw InputError(shown(outputs[i]) + ": is the same file as " + shown(input) +
                       ", which is read: name another file");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (outputs[k].path.empty() || !is_same_file(outputs[i].path, outputs[k].path)) continue;
      throw InputError(shown(outputs[i]) + ": is the same file as " + shown(outputs[k]) +
                       ", which is written too: name another file");
    }
  }
}

fs::path link_target(const fs::path& file) {
  constexpr int kMaxLinks = 40;  // as in Linux
  fs::path target = file;
  std::error_code error;
  for (int i = 0; fs::is_symlink(target, error); ++i) {
    const fs::path next = fs::read_symlink(target, error);
    if (error || i == kMaxLinks) throw InputError(to_text(file) + ": is a link that leads nowhere");
    target = target.parent_path() / next;  // replaces all if `next` is absolute
  }
  return target;
}

bool is_special_file(const fs::path& file) {
  if (is_device_name(file)) return true;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  return fs::exists(status) && !fs::is_regular_file(status);  // an error counts as absent: opening reports it
}

bool may_have_files_beside(const fs::path& file) {
  std::error_code error;
  const std::string folder = to_text(fs::absolute(file, error).lexically_normal().parent_path());
  return !is_special_file(file) && folder != "/dev" && folder != "/dev/fd" && !folder.starts_with("/proc");
}

void require_regular_output(const fs::path& file, const std::string& flag) {
  if (!is_special_file(file)) return;
  throw InputError(shown({flag, file}) +
                   ": is a device, a FIFO or a folder, must be a regular file or a name that is free");
}

void write_output(const fs::path& file, std::string_view bytes, const std::string& flag) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  out.close();
  if (out) return;
  throw InputError(shown({flag, file}) + ": cannot be written" +
                   (errno == 0 ? "" : std::string(": ") + std::strerror(errno)));
}

void replace_file(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  std::string name = to_text(file.parent_path() / ".") + to_text(file.filename()) + ".";
  constexpr mode_t kMode = 0666;  // less the umask
  const int descriptor = open_temporary_file(name, kMode);
  if (descriptor < 0) throw InputError(to_text(file) + ": cannot be written: " + std::strerror(errno));
  close(descriptor);
  std::error_code error;
  const fs::path temporary = to_path(name);
  try {
    write(temporary);
    fs::rename(temporary, file, error);
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
  if (!error) return;
  const std::string why = error.message();
  fs::remove(temporary, error);
  throw InputError(to_text(file) + ": cannot be written: " + why);
}

}  // namespace palpate
