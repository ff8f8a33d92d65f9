#include "run/devices/vendor_library.h"

#include <dlfcn.h>

namespace palpate::devices {

void* VendorFunctions::find(const char* name) const { return dlsym(handle_, name); }

std::string loader_text() {
  const char* reason = dlerror();  // NOLINT(concurrency-mt-unsafe): at set-up only
  std::string text = reason == nullptr ? "no reason given" : reason;
  for (char& letter : text) {
    if (letter == '\n') letter = ' ';
  }
  return text;
}

}  // namespace palpate::devices
