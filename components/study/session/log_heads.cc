#include "study/session/log_heads.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include "io/system/sha256.h"
#include "palpate/error.h"

namespace palpate::study {
namespace {

// A divisor of a disk's sector, so that a power failure leaves the old line or the new one.
constexpr std::size_t kLineBytes = 256;

std::string signed_part(const LogHead& head) { return fmt::format("{} {}", head.lines, head.mac); }

}  // namespace

LogHeads::LogHeads(std::filesystem::path file, Use use) : file_(std::move(file)) {
  const int access = use == Use::kRead ? O_RDONLY : O_RDWR;
  descriptor_ = ::open(file_.c_str(), access | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0) throw InputError(file_.string() + ": cannot be opened: " + std::strerror(errno));
  try {
    lock(use);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

LogHeads::~LogHeads() { ::close(descriptor_); }

void LogHeads::lock(Use use) const {
  if (use == Use::kRead) return;
  if (::flock(descriptor_, (use == Use::kUnblind ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) {
    throw InputError(file_.string() + ": cannot be locked: " + std::strerror(errno));
  }
  throw InputError(file_.string() + (use == Use::kUnblind ? ": a session is running: end it first"
                                                          : ": the study is just being unblinded"));
}

std::string LogHeads::text_of(const LogHead& head, const std::string& mac_key) {
  const std::string text = signed_part(head) + ' ' + hmac_sha256(mac_key, "head " + signed_part(head));
  return fmt::format("{:<{}}\n", text, kLineBytes - 1);
}

LogHead LogHeads::read(std::size_t line, const std::string& mac_key) const {
  // A line that another process writes meanwhile may be read in parts of two.
  constexpr int kTries = 10;
  for (int i = 0; i < kTries; ++i) {
    std::array<char, kLineBytes> bytes{};
    const ssize_t count =
        ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(kLineBytes * line));
    if (count < 0) throw InputError(file_.string() + ": cannot be read: " + std::strerror(errno));
    const std::string text(bytes.data(), static_cast<std::size_t>(count));
    LogHead head;
    std::array<char, 65> mac{};
    unsigned long long lines = 0;
    if (std::sscanf(text.c_str(), "%llu %64s", &lines, mac.data()) == 2) {
      head.lines = lines;
      head.mac = mac.data();
      if (text == text_of(head, mac_key)) return head;
    }
  }
  throw InputError(fmt::format("{}:{}: was changed: its mac does not fit", file_.string(), line + 1));
}

void LogHeads::flush() const {
  if (::fdatasync(descriptor_) == 0) return;
  throw InputError(file_.string() + ": cannot be written: " + std::strerror(errno));
}

void LogHeads::write(std::size_t line, const LogHead& head, const std::string& mac_key) const {
  const std::string text = text_of(head, mac_key);
  const ssize_t written =
      ::pwrite(descriptor_, text.data(), text.size(), static_cast<off_t>(kLineBytes * line));
  if (written == static_cast<ssize_t>(text.size())) return;
  throw InputError(file_.string() +
                   ": cannot be written: " + (written < 0 ? std::strerror(errno) : "the disk is full"));
}

}  // namespace palpate::study
