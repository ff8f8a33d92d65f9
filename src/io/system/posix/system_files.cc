#include "system_files.h"

namespace palpate {

int name_file(const std::filesystem::path& temporary, const std::filesystem::path& file) noexcept {
  if (::link(temporary.c_str(), file.c_str()) == 0) {
    ::unlink(temporary.c_str());
    return 0;
  }
  // File systems without hard links.
  if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS && errno != EMLINK) return errno;
  return ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, file.c_str(), RENAME_NOREPLACE) == 0 ? 0 : errno;
}

void flush_folder(const std::filesystem::path& folder) noexcept {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)!::fsync(descriptor);
  ::close(descriptor);
}

int reserve_space(int descriptor, std::int64_t end, std::int64_t bytes) noexcept {
  return ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, end, bytes) == 0 ? 0 : errno;
}

std::string path_of_open_file(int descriptor) {
  std::string name = "/proc/self/fd/" + std::to_string(descriptor);
  return ::access(name.c_str(), R_OK) == 0 ? name : std::string();  // a system without /proc
}

}  // namespace palpate
