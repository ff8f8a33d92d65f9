#include "io/system/shared_library.h"

#include <array>
#include <sstream>
#include <system_error>
#include <vector>

#include <windows.h>

#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/plugin.h"

namespace palpate {
namespace {

/// Where Windows would find a library, without the current folder, which may hold anybody's files. Empty:
/// nowhere.
std::filesystem::path find_library(const std::filesystem::path& name) {
  std::array<wchar_t, MAX_PATH> system{};
  (void)GetSystemDirectoryW(system.data(), MAX_PATH);
  std::vector<std::filesystem::path> folders = {folder_of_program(), system.data()};
  std::wistringstream path(environment_path("PATH").wstring());
  for (std::wstring folder; std::getline(path, folder, L';');) folders.emplace_back(folder);
  for (const std::filesystem::path& folder : folders) {
    if (folder.is_absolute() && file_exists(folder / name)) return folder / name;
  }
  return {};
}

}  // namespace

SharedLibrary open_library(const std::filesystem::path& file, Loading loading) {
  // Without this mode the system shows a window about a library that it cannot load.
  DWORD before = 0;
  (void)SetThreadErrorMode(SEM_FAILCRITICALERRORS | SEM_NOOPENFILEERRORBOX, &before);
  SharedLibrary library;
  const std::filesystem::path found = file.is_absolute() ? file : find_library(file);
  // Libraries that it needs may be beside it.
  if (!found.empty())
    library.handle = LoadLibraryExW(found.c_str(), nullptr, LOAD_WITH_ALTERED_SEARCH_PATH);
  else
    SetLastError(ERROR_MOD_NOT_FOUND);
  const DWORD error = GetLastError();
  (void)SetThreadErrorMode(before, nullptr);
  if (library.handle != nullptr) {
    HMODULE pinned = nullptr;
    if (loading == Loading::kForever)
      (void)GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN, found.c_str(), &pinned);
    return library;
  }
  library.is_missing =
      error == ERROR_MOD_NOT_FOUND || error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND;
  library.error = error == ERROR_BAD_EXE_FORMAT ? "it is no library for 64-bit Windows"
                                                : std::system_category().message(static_cast<int>(error));
  return library;
}

void* find_function(void* handle, const char* name) noexcept {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(handle), name));
}

void close_library(void* handle) noexcept { (void)FreeLibrary(static_cast<HMODULE>(handle)); }

}  // namespace palpate
