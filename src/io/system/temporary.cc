#include "io/system/temporary.h"

#include <cerrno>
#include <string_view>
#include <system_error>

#include "io/system/files.h"
#include "io/system/path_text.h"

namespace palpate {
namespace {

constexpr std::size_t kLetters = 6;

/// Random, unpredictable letters; empty when the system gives no random bytes.
std::string random_letters() {
  constexpr std::string_view kAlphabet = "abcdefghijklmnopqrstuvwxyz234567";  // 5 bits a letter
  std::string letters(kLetters, '\0');
  if (!random_bytes(letters.data(), letters.size())) return {};
  for (char& letter : letters) letter = kAlphabet[static_cast<unsigned char>(letter) % kAlphabet.size()];
  return letters;
}

}  // namespace

int open_temporary_file(std::string& path, mode_t mode) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    const std::string letters = random_letters();
    if (letters.empty()) return -1;
    const std::string name = path + letters;
    // O_EXCL: fails if the name exists, even as a link.
    const int descriptor = open_file(to_path(name), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (descriptor >= 0) path = name;
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

std::filesystem::path make_temporary_folder(const std::filesystem::path& path) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    const std::string letters = random_letters();
    if (letters.empty()) return {};
    std::filesystem::path folder = path;
    folder += to_path(letters);
    if (make_folder(folder) == 0) return folder;
    if (errno != EEXIST) return {};
  }
  return {};
}

ScratchFolder::ScratchFolder(const std::string& name) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  path_ = make_temporary_folder((error ? "/tmp" : parent) / name);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace palpate
