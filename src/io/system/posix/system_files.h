#pragma once
// io/system/files.h for POSIX systems.
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace palpate {

inline constexpr bool kIsWindows = false;
/// Locks keep out only programs that ask for them, so HDF5 may lock files that others read.
inline constexpr bool kLocksAreAdvisory = true;
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
inline std::ptrdiff_t write_next(int descriptor, const void* bytes, std::size_t count) noexcept {
  return ::write(descriptor, bytes, count);
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
/// [setup] Whether users other than the owner may write to a file, or do anything with it.
inline bool is_open_to_others(const FileStatus& status) noexcept {
  return (status.st_mode & (S_IWGRP | S_IWOTH)) != 0;
}
inline bool is_usable_by_others(const FileStatus& status) noexcept {
  return (status.st_mode & (S_IRWXG | S_IRWXO)) != 0;
}
/// [setup] Whether the system opens a device for this name in any folder: NUL, COM1.txt, ... on Windows.
inline bool is_device_name(const std::filesystem::path& /*file*/) noexcept { return false; }
/// [setup] Whether this process may write to a file, or create files in a folder.
inline bool may_write(const std::filesystem::path& path) noexcept {
  return ::access(path.c_str(), W_OK) == 0;
}
/// [setup] Gives a file the rights `mode`; those of a new file are less the process's umask.
inline void set_rights(int descriptor, mode_t mode) noexcept { (void)!::fchmod(descriptor, mode); }
inline mode_t less_the_umask(mode_t mode) noexcept {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return mode & ~mask;
}
/// [setup] Sets the length of a file. @return 0, or -1 with errno
inline int set_length(int descriptor, std::uint64_t bytes) noexcept {
  return ::ftruncate(descriptor, static_cast<off_t>(bytes));
}
/// [setup] Writes a file's content to the disk. @return 0, or -1 with errno
inline int flush_to_disk(int descriptor) noexcept { return ::fsync(descriptor); }
/// [setup] As flush_to_disk(), without the file's times.
inline int flush_content(int descriptor) noexcept { return ::fdatasync(descriptor); }
/// [setup] Gives a temporary file its name, which no file may have. @return 0, or errno
int name_file(const std::filesystem::path& temporary, const std::filesystem::path& file) noexcept;
/// [setup] Flushes a folder's list of files to the disk, so that a new file stays after a power failure.
/// Where the system cannot do that, nothing happens.
void flush_folder(const std::filesystem::path& folder) noexcept;

enum class FileLock { kShared, kExclusive };
/// [setup] Locks a file until its descriptor is closed, without waiting. @return false when another program
/// holds a lock that excludes this one; an error counts as success
inline bool lock_file(int descriptor, FileLock lock) noexcept {
  return ::flock(descriptor, (lock == FileLock::kShared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0 ||
         errno != EWOULDBLOCK;
}
inline void unlock_file(int descriptor) noexcept { (void)::flock(descriptor, LOCK_UN); }

/// [setup] Reserves disk space beyond the end of a file, whose length stays. @return 0, or errno
int reserve_space(int descriptor, std::int64_t end, std::int64_t bytes) noexcept;
/// [setup] Whether an errno says that the disk or the user's share of it is full.
inline bool is_disk_full(int error) noexcept { return error == ENOSPC || error == EDQUOT; }
/// [setup] Returns the space beyond the end of a file that nobody has open. @param end its length
inline void release_space(const std::filesystem::path& file, std::int64_t end) noexcept {
  (void)!::truncate(file.c_str(), end);
}
/// [setup] A path by which an open file can be opened again, although another file may get its name. Empty:
/// none.
[[nodiscard]] std::string path_of_open_file(int descriptor);

/// [setup] The path in an environment variable; empty when it is not set.
inline std::filesystem::path environment_path(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): at set-up, nothing writes it
  return value == nullptr ? std::filesystem::path() : std::filesystem::path(value);
}
/// [setup] Unpredictable bytes. @return whether the system gave them
inline bool random_bytes(char* bytes, std::size_t count) noexcept { return ::getentropy(bytes, count) == 0; }
/// [setup] The number of this process.
inline int process_id() noexcept { return ::getpid(); }

}  // namespace palpate
