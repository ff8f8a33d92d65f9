#include "io/system/shared_library.h"

#include <algorithm>

#include <dlfcn.h>

namespace palpate {

SharedLibrary open_library(const std::filesystem::path& file, Loading loading) {
  const int extra = loading == Loading::kShared    ? RTLD_GLOBAL
                    : loading == Loading::kForever ? RTLD_LOCAL | RTLD_NODELETE
                                                   : RTLD_LOCAL;
  SharedLibrary library{dlopen(file.c_str(), RTLD_NOW | extra)};
  if (library.handle != nullptr) return library;
  const char* reason = dlerror();  // NOLINT(concurrency-mt-unsafe): at set-up only
  library.error = reason == nullptr ? "no reason given" : reason;
  std::replace(library.error.begin(), library.error.end(), '\n', ' ');
  library.is_missing = library.error.rfind(file.string() + ": cannot open shared object file", 0) == 0;
  return library;
}

void* find_function(void* handle, const char* name) noexcept { return dlsym(handle, name); }

void close_library(void* handle) noexcept { dlclose(handle); }

}  // namespace palpate
