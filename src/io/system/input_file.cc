#include "io/system/input_file.h"

#include <cerrno>
#include <cstring>

#include "io/system/file_content.h"
#include "io/system/files.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate {
namespace {

const char* type_text(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

std::string size_text(std::uint64_t bytes) {
  if (bytes >= std::uint64_t{10} << 20) return std::to_string(bytes >> 20) + " MiB";
  if (bytes >= std::uint64_t{10} << 10) return std::to_string(bytes >> 10) + " KiB";
  return std::to_string(bytes) + " bytes";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file, const InputKind& kind)
    : name_(to_text(file)), kind_(kind) {
  // Without O_NONBLOCK, opening a FIFO blocks until a writer opens it.
  descriptor_ = open_file(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (descriptor_ < 0) {
    const int why = errno;
    if (why == ENOENT || why == ENOTDIR) throw InputError(name_ + ": there is no such file");
    if (why == ENXIO) throw InputError(name_ + ": is a socket or a device, must be " + kind_.name);
    throw InputError(name_ + ": cannot be read: " + std::strerror(why));
  }
  try {
    check();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

InputFile::~InputFile() { ::close(descriptor_); }

void InputFile::check() {
  FileStatus facts{};
  if (status_of(descriptor_, facts) != 0) {
    throw InputError(name_ + ": cannot be read: " + std::strerror(errno));
  }
  if (!S_ISREG(facts.st_mode)) {
    const ContentFacts known = S_ISDIR(facts.st_mode) ? find_content(to_path(name_)) : ContentFacts{};
    throw InputError(name_ + ": is " + type_text(facts.st_mode) + ", must be " + kind_.name +
                     (known.name.empty() ? "" : "; it is " + known.name + ": " + known.use));
  }
  size_ = static_cast<std::uint64_t>(facts.st_size);
  if (size_ > kind_.max_bytes) {
    throw InputError(name_ + ": has " + size_text(size_) + ", must be " + kind_.name + " of at most " +
                     size_text(kind_.max_bytes));
  }
}

std::size_t InputFile::read(std::span<char> bytes) {
  for (;;) {
    const std::ptrdiff_t count = read_next(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(name_ + ": cannot be read to its end: " + std::strerror(errno));
    taken_ += static_cast<std::uint64_t>(count);
    if (taken_ > kind_.max_bytes) {
      throw InputError(name_ + ": has more than " + size_text(kind_.max_bytes) + ", must be " + kind_.name +
                       " of at most that");
    }
    return static_cast<std::size_t>(count);
  }
}

std::string InputFile::read_rest() {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string content;
  content.resize(static_cast<std::size_t>(size_ > taken_ ? size_ - taken_ : 0));
  std::size_t filled = 0;
  for (;;) {  // a file may grow, and files in /proc have size 0
    if (filled == content.size()) content.resize(filled + kBlock);
    const std::size_t count = read(std::span(content).subspan(filled));
    if (count == 0) break;
    filled += count;
  }
  content.resize(filled);
  return content;
}

}  // namespace palpate
