#include "io/system/shared_library.h"

#include <system_error>

#include <windows.h>

namespace palpate {

SharedLibrary open_library(const std::filesystem::path& file, Loading loading) {
  // Without this mode the system shows a window about a library that it cannot load.
  DWORD before = 0;
  (void)SetThreadErrorMode(SEM_FAILCRITICALERRORS | SEM_NOOPENFILEERRORBOX, &before);
  SharedLibrary library{LoadLibraryW(file.c_str())};
  const DWORD error = GetLastError();
  (void)SetThreadErrorMode(before, nullptr);
  if (library.handle != nullptr) {
    HMODULE pinned = nullptr;
    if (loading == Loading::kForever)
      (void)GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN, file.c_str(), &pinned);
    return library;
  }
  library.is_missing =
      error == ERROR_MOD_NOT_FOUND || error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND;
  library.error = std::system_category().message(static_cast<int>(error));
  return library;
}

void* find_function(void* handle, const char* name) noexcept {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(handle), name));
}

void close_library(void* handle) noexcept { (void)FreeLibrary(static_cast<HMODULE>(handle)); }

}  // namespace palpate
