#include "system_files.h"

#include <cerrno>

#include <windows.h>

namespace palpate {
namespace {

// Windows' locks keep every program from reading and writing what is locked, so this is one byte far beyond
// any file's end, as a mark.
constexpr DWORD kMarkHigh = 0x4000'0000;

HANDLE handle_of(int descriptor) noexcept { return reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor)); }

OVERLAPPED mark() noexcept {
  OVERLAPPED place{};
  place.OffsetHigh = kMarkHigh;
  return place;
}

}  // namespace

int name_file(const std::filesystem::path& temporary, const std::filesystem::path& file) noexcept {
  if (MoveFileExW(temporary.c_str(), file.c_str(), MOVEFILE_WRITE_THROUGH) != 0) return 0;
  const DWORD error = GetLastError();
  return error == ERROR_ALREADY_EXISTS || error == ERROR_FILE_EXISTS ? EEXIST : EACCES;
}

bool lock_file(int descriptor, FileLock lock) noexcept {
  OVERLAPPED place = mark();
  const DWORD how = LOCKFILE_FAIL_IMMEDIATELY | (lock == FileLock::kExclusive ? LOCKFILE_EXCLUSIVE_LOCK : 0);
  if (LockFileEx(handle_of(descriptor), how, 0, 1, 0, &place) != 0) return true;
  const DWORD error = GetLastError();
  return error != ERROR_LOCK_VIOLATION && error != ERROR_IO_PENDING;
}

void unlock_file(int descriptor) noexcept {
  OVERLAPPED place = mark();
  (void)UnlockFileEx(handle_of(descriptor), 0, 1, 0, &place);
}

int reserve_space(int descriptor, std::int64_t end, std::int64_t bytes) noexcept {
  FILE_ALLOCATION_INFO space{};
  space.AllocationSize.QuadPart = end + bytes;
  if (SetFileInformationByHandle(handle_of(descriptor), FileAllocationInfo, &space, sizeof space) != 0)
    return 0;
  return GetLastError() == ERROR_DISK_FULL ? ENOSPC : EINVAL;
}

bool is_wine() noexcept {
  const HMODULE system = GetModuleHandleW(L"ntdll.dll");
  return system != nullptr && GetProcAddress(system, "wine_get_version") != nullptr;
}

}  // namespace palpate
