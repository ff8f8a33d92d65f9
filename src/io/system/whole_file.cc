#include "io/system/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Writes all bytes and flushes them to the disk. @return 0, or errno
int write_and_flush(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0 ? 0 : errno;
}

/// Gives a file its name, which no file may have. @return 0, or errno
int name_file(const std::string& temporary, const fs::path& file) {
  if (::link(temporary.c_str(), file.c_str()) == 0) {
    ::unlink(temporary.c_str());
    return 0;
  }
  // File systems without hard links.
  if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS && errno != EMLINK) return errno;
  return ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, file.c_str(), RENAME_NOREPLACE) == 0 ? 0 : errno;
}

[[noreturn]] void fail(const fs::path& file, const char* what, int why) {
  throw InputError(to_text(file) + ": " + what + ": " + std::strerror(why));
}

}  // namespace

void create_whole_file(const fs::path& file, std::string_view bytes, mode_t mode) {
  const fs::path folder = file.parent_path();
  std::string temporary = (folder / ("." + file.filename().string() + ".")).string();
  // Others may read it only once it has its name: a killed process leaves the temporary file behind.
  constexpr mode_t kOwnerOnly = 0600;
  const int descriptor = open_temporary_file(temporary, kOwnerOnly);
  if (descriptor < 0) fail(file, "cannot be created", errno);
  const int unwritten = write_and_flush(descriptor, bytes);
  const int unnamed = unwritten == 0 ? name_file(temporary, file) : 0;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (unwritten + unnamed == 0) ::fchmod(descriptor, mode & ~mask);
  ::close(descriptor);  // its bytes are on the disk
  if (unwritten + unnamed != 0) ::unlink(temporary.c_str());
  if (unwritten != 0) fail(file, "cannot be written", unwritten);
  if (unnamed == EEXIST) throw InputError(to_text(file) + ": exists and is not overwritten");
  if (unnamed != 0) fail(file, "cannot be created", unnamed);
  flush_folder(folder);
}

std::string name_of_unfinished(const fs::path& temporary) {
  constexpr std::size_t kEnding = 7;  // the second dot and six letters
  const std::string name = temporary.filename().string();
  if (name.size() < kEnding + 2 || name.front() != '.' || name[name.size() - kEnding] != '.') return {};
  return name.substr(1, name.size() - 1 - kEnding);
}

void flush_folder(const fs::path& folder) noexcept {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace palpate
