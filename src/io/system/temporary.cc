#include "io/system/temporary.h"

#include <cstdlib>

#include <fcntl.h>

namespace palpate {
namespace {

/// With the six letters that POSIX puts its own in place of.
std::string with_letters(const std::string& begin) { return begin + std::string(6, 'X'); }

}  // namespace

int open_temporary_file(std::string& path) {
  std::string name = with_letters(path);
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) path = name;
  return descriptor;
}

std::filesystem::path make_temporary_folder(const std::filesystem::path& path) {
  std::string name = with_letters(path.string());
  return mkdtemp(name.data()) == nullptr ? std::filesystem::path() : std::filesystem::path(name);
}

}  // namespace palpate
