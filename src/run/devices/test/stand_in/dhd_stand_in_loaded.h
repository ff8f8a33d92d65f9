#pragma once
#include <stdexcept>
#include <string>

#include "io/system/shared_library.h"
#include "run/devices/test/stand_in/dhd_stand_in.h"

namespace palpate::devices::stand_in {

/// Keeps a stand-in library open for a test. The code under test opens the same library in memory, and finds
/// the values that the test sets here.
class Loaded final {
 public:
  explicit Loaded(std::string file) : path(std::move(file)), opened_(open_library(path)) {
    if (opened_.handle == nullptr) throw std::runtime_error(opened_.error);
    library = reinterpret_cast<Entry>(find_function(opened_.handle, kEntry))();
    *library = Library{};
  }
  ~Loaded() { close_library(opened_.handle); }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;

  [[nodiscard]] Device& device(int index = 0) const { return library->devices[index]; }

  std::string path;
  Library* library = nullptr;

 private:
  SharedLibrary opened_;
};

/// File of a variant of the library. src/run/devices/CMakeLists.txt gives the names.
inline std::string file_of(const std::string& variant) {
  return std::string(PALPATE_STAND_IN_FOLDER) + "/lib" + variant + PALPATE_STAND_IN_SUFFIX;
}

}  // namespace palpate::devices::stand_in
