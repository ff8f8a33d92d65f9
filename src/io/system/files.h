#pragma once
// Files by descriptor with POSIX's functions, some of which Windows has under another name or not at all.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#if defined(_WIN32)
#include "io/system/windows/files.h"
#else
#include <sys/random.h>

namespace palpate {

inline constexpr bool kIsWindows = false;
using FileStatus = struct stat;

/// [setup] As POSIX's functions, for a path of this system.
inline int open_file(const std::filesystem::path& file, int flags, mode_t mode = 0) noexcept {
  return ::open(file.c_str(), flags, mode);
}
inline int status_of(const std::filesystem::path& file, FileStatus& status) noexcept {
  return ::stat(file.c_str(), &status);
}
inline int status_of(int descriptor, FileStatus& status) noexcept { return ::fstat(descriptor, &status); }
inline std::ptrdiff_t read_next(int descriptor, void* bytes, std::size_t count) noexcept {
  return ::read(descriptor, bytes, count);
}
inline std::ptrdiff_t read_at(int descriptor, void* bytes, std::size_t count, std::uint64_t offset) noexcept {
  return ::pread(descriptor, bytes, count, static_cast<off_t>(offset));
}
inline std::ptrdiff_t write_at(int descriptor, const void* bytes, std::size_t count,
                               std::uint64_t offset) noexcept {
  return ::pwrite(descriptor, bytes, count, static_cast<off_t>(offset));
}
/// [setup] Creates a folder that only this user may read. @return 0; -1 when it exists or on an error
inline int make_folder(const std::filesystem::path& folder) noexcept {
  return ::mkdir(folder.c_str(), S_IRWXU);
}
/// [setup] Whether a file belongs to this process's user.
inline bool is_of_this_user(const FileStatus& status) noexcept { return status.st_uid == geteuid(); }
/// [setup] Whether users other than the owner may write to a file.
inline bool is_open_to_others(const FileStatus& status) noexcept {
  return (status.st_mode & (S_IWGRP | S_IWOTH)) != 0;
}
/// [setup] The path in an environment variable; empty when it is not set.
inline std::filesystem::path environment_path(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): at set-up, nothing writes it
  return value == nullptr ? std::filesystem::path() : std::filesystem::path(value);
}
/// [setup] Unpredictable bytes. @return whether the system gave them
inline bool random_bytes(char* bytes, std::size_t count) noexcept { return ::getentropy(bytes, count) == 0; }

}  // namespace palpate
#endif
