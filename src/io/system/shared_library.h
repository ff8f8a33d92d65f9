#pragma once
#include <filesystem>
#include <string>

namespace palpate {

/// A shared library (libNAME.so, NAME.dll) that was opened at run time.
struct SharedLibrary {
  void* handle = nullptr;   // null: it was not opened
  bool is_missing = false;  // the loader finds no such file
  std::string error{};      // the loader's reason, on one line
};

/// How a library is opened.
enum class Loading {
  kPrivate,  // other libraries do not see its functions
  kShared,   // they do (plug-ins of Open MPI need it)
  kForever,  // as kPrivate; it stays loaded after close_library()
};

/// [setup] Opens a library: a path, or a name that the system's loader finds.
[[nodiscard]] SharedLibrary open_library(const std::filesystem::path& file,
                                         Loading loading = Loading::kPrivate);
/// [setup] The address of a function; null: the library has none of this name.
[[nodiscard]] void* find_function(void* handle, const char* name) noexcept;
/// [setup]
void close_library(void* handle) noexcept;

}  // namespace palpate
