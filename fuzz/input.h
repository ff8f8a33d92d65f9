#pragma once
// What the fuzz targets share: the file that a reader is given, and what it may say of it.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate::fuzz {

/// A file in a folder of its own, written again for each input; both are gone when the process ends.
class InputFile final {
 public:
  /// @param ending with its dot, by which readers tell formats
  explicit InputFile(const std::string& ending) {
    folder_ = make_temporary_folder(std::filesystem::temp_directory_path() / "palpate-fuzz-");
    if (folder_.empty()) throw std::runtime_error("no temporary folder");
    file_ = folder_ / ("input" + ending);
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] const std::filesystem::path& hold(std::span<const std::uint8_t> bytes) const {
    std::ofstream out(file_, std::ios::binary | std::ios::trunc);
    for (const std::uint8_t byte : bytes) out.put(static_cast<char>(byte));
    return file_;
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path file_;
};

/// Ends the process, so that the fuzzer keeps the input, when `holds` is false.
inline void require(bool holds, const std::string& claim, const std::string& found = "") {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n%s\n", claim.c_str(), found.c_str());
  std::abort();
}

/// Runs a reader, which may end well or refuse by an InputError of one line with `name` in it. Any other
/// exception leaves the target, which the fuzzer takes for the finding that it is.
template <typename Read>
void read_or_refuse(const std::string& name, Read&& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string message = error.what();
    require(message.find_first_of("\r\n") == std::string::npos, "a refusal is one line", message);
    require(message.find(name) != std::string::npos, "a refusal names the file", message);
  }
}

}  // namespace palpate::fuzz
