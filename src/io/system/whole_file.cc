#include "io/system/whole_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Writes all bytes and flushes them to the disk. @return 0, or errno
int write_and_flush(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const std::ptrdiff_t written = write_next(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return flush_to_disk(descriptor) == 0 ? 0 : errno;
}

[[noreturn]] void fail(const fs::path& file, const char* what, int why) {
  throw InputError(to_text(file) + ": " + what + ": " + std::strerror(why));
}

}  // namespace

void create_whole_file(const fs::path& file, std::string_view bytes, mode_t mode) {
  const fs::path folder = file.parent_path();
  std::string temporary = to_text(folder / to_path("." + to_text(file.filename()) + "."));
  // Others may read it only once it has its name: a killed process leaves the temporary file behind.
  constexpr mode_t kOwnerOnly = 0600;
  const int descriptor = open_temporary_file(temporary, kOwnerOnly);
  if (descriptor < 0) fail(file, "cannot be created", errno);
  const int unwritten = write_and_flush(descriptor, bytes);
  const int unnamed = unwritten == 0 ? name_file(to_path(temporary), file) : 0;
  if (unwritten + unnamed == 0) set_rights(descriptor, less_the_umask(mode));
  ::close(descriptor);  // its bytes are on the disk
  std::error_code ignored;
  if (unwritten + unnamed != 0) fs::remove(to_path(temporary), ignored);
  if (unwritten != 0) fail(file, "cannot be written", unwritten);
  if (unnamed == EEXIST) throw InputError(to_text(file) + ": exists and is not overwritten");
  if (unnamed != 0) fail(file, "cannot be created", unnamed);
  flush_folder(folder);
}

std::string name_of_unfinished(const fs::path& temporary) {
  constexpr std::size_t kEnding = 7;  // the second dot and six letters
  const std::string name = to_text(temporary.filename());
  if (name.size() < kEnding + 2 || name.front() != '.' || name[name.size() - kEnding] != '.') return {};
  return name.substr(1, name.size() - 1 - kEnding);
}

}  // namespace palpate
