#pragma once
// io/system/files.h for Windows, by mingw-w64's C library.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <io.h>
#include <process.h>

// Flags that Windows lacks, and its own: a file without conversion of line ends, which child programs do not
// inherit.
#define O_CLOEXEC (_O_NOINHERIT | _O_BINARY)
#define O_NONBLOCK 0
#define O_NOCTTY 0
#define O_NOFOLLOW 0
#define S_ISSOCK(mode) false

namespace palpate {

inline constexpr bool kIsWindows = true;
inline constexpr bool kLocksAreAdvisory = false;
using FileStatus = struct _stat64;

/// As _wopen(), but others may rename and delete the file while it is open, as on POSIX systems. HDF5 calls
/// it, too (tools/make_windows_libraries).
extern "C" int palpate_open_wide(const wchar_t* path, int flags, int mode);

inline int open_file(const std::filesystem::path& file, int flags, mode_t mode = 0) noexcept {
  return palpate_open_wide(file.c_str(), flags, mode);
}
inline int status_of(const std::filesystem::path& file, FileStatus& status) noexcept {
  return ::_wstat64(file.c_str(), &status);
}
inline int status_of(int descriptor, FileStatus& status) noexcept { return ::_fstat64(descriptor, &status); }

inline constexpr std::size_t kMaxBytesAtOnce = std::size_t{1} << 30;
inline std::ptrdiff_t read_next(int descriptor, void* bytes, std::size_t count) noexcept {
  return ::_read(descriptor, bytes, static_cast<unsigned>(std::min(count, kMaxBytesAtOnce)));
}
inline std::ptrdiff_t write_next(int descriptor, const void* bytes, std::size_t count) noexcept {
  return ::_write(descriptor, bytes, static_cast<unsigned>(std::min(count, kMaxBytesAtOnce)));
}
inline std::ptrdiff_t read_at(int descriptor, void* bytes, std::size_t count, std::uint64_t offset) noexcept {
  if (::_lseeki64(descriptor, static_cast<std::int64_t>(offset), SEEK_SET) < 0) return -1;
  return read_next(descriptor, bytes, count);
}
inline std::ptrdiff_t write_at(int descriptor, const void* bytes, std::size_t count,
                               std::uint64_t offset) noexcept {
  if (::_lseeki64(descriptor, static_cast<std::int64_t>(offset), SEEK_SET) < 0) return -1;
  return write_next(descriptor, bytes, count);
}
// Windows has no such rights in a file's status; a user's folders are closed to other users.
inline int make_folder(const std::filesystem::path& folder) noexcept { return ::_wmkdir(folder.c_str()); }
inline bool is_of_this_user(const FileStatus& /*status*/) noexcept { return true; }
inline bool is_open_to_others(const FileStatus& /*status*/) noexcept { return false; }
inline bool is_usable_by_others(const FileStatus& /*status*/) noexcept { return false; }
bool is_device_name(const std::filesystem::path& file);
inline bool may_write(const std::filesystem::path& path) noexcept { return ::_waccess(path.c_str(), 2) == 0; }
inline void set_rights(int /*descriptor*/, mode_t /*mode*/) noexcept {}
inline mode_t less_the_umask(mode_t mode) noexcept { return mode; }
inline int set_length(int descriptor, std::uint64_t bytes) noexcept {
  return ::_chsize_s(descriptor, static_cast<std::int64_t>(bytes)) == 0 ? 0 : -1;
}
inline int flush_to_disk(int descriptor) noexcept { return ::_commit(descriptor); }
inline int flush_content(int descriptor) noexcept { return ::_commit(descriptor); }
int name_file(const std::filesystem::path& temporary, const std::filesystem::path& file) noexcept;
// The file system writes its lists by a journal.
inline void flush_folder(const std::filesystem::path& /*folder*/) noexcept {}

enum class FileLock { kShared, kExclusive };
bool lock_file(int descriptor, FileLock lock) noexcept;
void unlock_file(int descriptor) noexcept;

int reserve_space(int descriptor, std::int64_t end, std::int64_t bytes) noexcept;
inline bool is_disk_full(int error) noexcept { return error == ENOSPC; }
// Windows returns it when the file is closed.
inline void release_space(const std::filesystem::path& /*file*/, std::int64_t /*end*/) noexcept {}
inline std::string path_of_open_file(int /*descriptor*/) { return {}; }

inline std::filesystem::path environment_path(const char* name) {
  const wchar_t* value = ::_wgetenv(std::filesystem::path(name).c_str());
  return value == nullptr ? std::filesystem::path() : std::filesystem::path(value);
}
inline bool random_bytes(char* bytes, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    unsigned value = 0;
    if (::rand_s(&value) != 0) return false;
    bytes[i] = static_cast<char>(value);
  }
  return true;
}
/// [setup] Whether this is Wine and no Windows.
bool is_wine() noexcept;
inline int process_id() noexcept { return ::_getpid(); }

}  // namespace palpate
