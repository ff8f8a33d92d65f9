#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cwchar>
#include <cwctype>
#include <string>

#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include "system_files.h"

namespace palpate {

// NUL, COM1, ..., with any ending
bool is_device_name(const std::filesystem::path& file) {
  std::wstring name = file.filename().wstring();
  name.resize(std::min(name.size(), name.find_first_of(L".: ")));
  for (wchar_t& letter : name) letter = static_cast<wchar_t>(std::towupper(letter));
  if (name == L"CON" || name == L"PRN" || name == L"AUX" || name == L"NUL") return true;
  const bool numbered = name.size() == 4 && name[3] >= L'0' && name[3] <= L'9';
  return numbered && (name.starts_with(L"COM") || name.starts_with(L"LPT"));
}

}  // namespace palpate

namespace {

int error_of(DWORD error) noexcept {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
      return ENOENT;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_DISK_FULL:
      return ENOSPC;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    default:
      return EACCES;
  }
}

DWORD creation_of(int flags) noexcept {
  if ((flags & _O_CREAT) == 0) return (flags & _O_TRUNC) != 0 ? TRUNCATE_EXISTING : OPEN_EXISTING;
  if ((flags & _O_EXCL) != 0) return CREATE_NEW;
  return (flags & _O_TRUNC) != 0 ? CREATE_ALWAYS : OPEN_ALWAYS;
}

}  // namespace

extern "C" int palpate_open_wide(const wchar_t* path, int flags, int /*mode*/) {
  if (palpate::is_device_name(path)) {
    errno = ENXIO;
    return -1;
  }
  const int access = flags & (_O_RDONLY | _O_WRONLY | _O_RDWR);
  const DWORD wanted = access == _O_RDWR     ? GENERIC_READ | GENERIC_WRITE
                       : access == _O_WRONLY ? GENERIC_WRITE
                                             : GENERIC_READ;
  const DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
  // A folder opens, too, so that the caller can say that it is one.
  HANDLE file = CreateFileW(path, wanted, kShared, nullptr, creation_of(flags),
                            FILE_ATTRIBUTE_NORMAL | FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  if (file == INVALID_HANDLE_VALUE) {
    errno = error_of(GetLastError());
    return -1;
  }
  const int descriptor = _open_osfhandle(reinterpret_cast<std::intptr_t>(file), flags);
  if (descriptor < 0) CloseHandle(file);
  return descriptor;
}
