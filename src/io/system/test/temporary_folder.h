#pragma once
// A folder for the files of one test, for the tests of all modules.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "io/system/temporary.h"

namespace palpate::test {

/// An empty folder, removed by its destructor.
class TemporaryFolder : public ScratchFolder {
 public:
  TemporaryFolder() : ScratchFolder("palpate-test-") {
    if (path().empty()) throw std::runtime_error("no temporary folder");
  }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path() / name; }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path()), {}));
  }
  [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path() / name, std::ios::binary) << bytes;
    return path() / name;
  }
};

}  // namespace palpate::test
