#pragma once
// Shared by the fuzz targets: an input file, and checks of a reader's errors.
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

/// A file in a temporary folder, rewritten for each input. The destructor removes both.
class InputFile final {
 public:
  /// @param ending file name extension with its dot, from which readers derive the format
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
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return file_;
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path file_;
};

/// Aborts the process if `holds` is false, so that the fuzzer keeps the input.
inline void require(bool holds, const std::string& claim, const std::string& found = "") {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n%s\n", claim.c_str(), found.c_str());
  std::abort();
}

/// Runs a reader, which may succeed or throw an InputError of one line that contains `name`. Any other
/// exception leaves the target and counts as a finding.
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
