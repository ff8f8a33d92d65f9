#pragma once
#include <stdexcept>
#include <string>

#include <dlfcn.h>

#include "run/devices/test/stand_in/dhd_stand_in.h"

namespace palpate::devices::stand_in {

/// Keeps a stand-in library open for a test. The code under test opens the same library in memory, and finds
/// the values that the test sets here.
class Loaded final {
 public:
  explicit Loaded(std::string file) : path(std::move(file)), handle_(dlopen(path.c_str(), RTLD_NOW)) {
    if (handle_ == nullptr) throw std::runtime_error(dlerror());  // NOLINT(concurrency-mt-unsafe): one thread
    library = reinterpret_cast<Entry>(dlsym(handle_, kEntry))();
    *library = Library{};
  }
  ~Loaded() { dlclose(handle_); }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;

  [[nodiscard]] Device& device(int index = 0) const { return library->devices[index]; }

  std::string path;
  Library* library = nullptr;

 private:
  void* handle_;
};

/// File of a variant of the library. src/run/devices/CMakeLists.txt gives the names.
inline std::string file_of(const std::string& variant) {
  return std::string(PALPATE_STAND_IN_FOLDER) + "/lib" + variant + ".so";
}

}  // namespace palpate::devices::stand_in
