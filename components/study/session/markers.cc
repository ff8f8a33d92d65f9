#include "study/session/markers.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "core/base/text.h"
#include "io/system/clock.h"
#include "palpate/error.h"
#include "run/realtime/realtime.h"

namespace palpate::study {
namespace {

constexpr int kLargestPort = 65535;
constexpr int kConnectTime = 3000;  // ms

struct Baud {
  int number;
  speed_t speed;
};
constexpr std::array<Baud, 7> kBauds{{{9600, B9600},
                                      {19200, B19200},
                                      {38400, B38400},
                                      {57600, B57600},
                                      {115200, B115200},
                                      {230400, B230400},
                                      {921600, B921600}}};

const char* name_of(MarkerCode code) {
  constexpr std::array<const char*, 6> kNames{"", "interval 1", "interval 2", "first", "second", "no answer"};
  return kNames.at(static_cast<std::size_t>(code));
}

/// @return 0, or errno
int set_raw(int descriptor, int baud) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return errno;
  ::cfmakeraw(&settings);
  settings.c_cflag |= static_cast<tcflag_t>(CLOCAL);
  const auto* found =
      std::find_if(kBauds.begin(), kBauds.end(), [&](const Baud& one) { return one.number == baud; });
  if (::cfsetspeed(&settings, found->speed) != 0) return errno;
  return ::tcsetattr(descriptor, TCSANOW, &settings) == 0 ? 0 : errno;
}

[[noreturn]] void fail_to_open(const MarkerTarget& target, const std::string& why) {
  throw InputError(fmt::format("markers {}: {}", target.text, why));
}

int open_serial(const MarkerTarget& target) {
  const int descriptor = ::open(target.name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    fail_to_open(target, std::string("cannot be opened: ") + std::strerror(errno) +
                             (errno == EACCES ? "; the user must be in the group dialout" : ""));
  }
  const int error = set_raw(descriptor, target.number);
  if (error == 0) return descriptor;
  ::close(descriptor);
  fail_to_open(target, error == ENOTTY ? "is no serial port" : std::strerror(error));
}

/// Connects within kConnectTime. @return 0, or errno
int connect_to(int descriptor, const addrinfo& address) {
  if (::connect(descriptor, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd ready{descriptor, POLLOUT, 0};
  if (::poll(&ready, 1, kConnectTime) == 0) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

int open_tcp(const MarkerTarget& target) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int unknown =
      ::getaddrinfo(target.name.c_str(), std::to_string(target.number).c_str(), &wanted, &found);
  if (unknown != 0) fail_to_open(target, ::gai_strerror(unknown));
  int descriptor = -1;
  int error = 0;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    descriptor = ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    error = descriptor < 0 ? errno : connect_to(descriptor, *address);
    if (error == 0) break;
    if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
  }
  ::freeaddrinfo(found);
  if (error != 0) fail_to_open(target, std::string("cannot be connected: ") + std::strerror(error));
  const int on = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return descriptor;
}

int number_in(const std::string& digits) {
  const auto number = parse_number(digits);
  return number && *number >= 1.0 && *number == std::floor(*number) && *number <= 1e7
             ? static_cast<int>(*number)
             : 0;
}

}  // namespace

/// An open target. It is closed after its first failure.
struct Markers::Port {
  explicit Port(const MarkerTarget& of)
      : target(of), descriptor(of.serial ? open_serial(of) : open_tcp(of)) {}
  ~Port() {
    if (descriptor >= 0) ::close(descriptor);
  }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  /// @return the reason of a failure, or an empty text
  std::string write(const std::string& line, std::uint8_t byte) {
    if (descriptor < 0) return "is closed";
    const std::string bytes = target.serial ? std::string(1, static_cast<char>(byte)) : line;
    // A server that has closed the connection still takes the next line.
    char unread = 0;
    const bool ended = !target.serial && ::recv(descriptor, &unread, 1, MSG_PEEK) == 0;
    const ssize_t written = ended           ? 0
                            : target.serial ? ::write(descriptor, bytes.data(), bytes.size())
                                            : ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (written == static_cast<ssize_t>(bytes.size())) return "";
    std::string why = ended         ? "the connection was closed"
                      : written < 0 ? std::strerror(errno)
                                    : "takes no more";
    ::close(std::exchange(descriptor, -1));
    return why;
  }

  MarkerTarget target;
  int descriptor;
};

MarkerTarget parse_marker_target(const std::string& text, const std::string& who) {
  MarkerTarget target;
  target.text = text;
  target.serial = text.starts_with("serial:");
  const std::string rest = text.substr(std::min(text.size(), text.find(':') + 1));
  const std::size_t split = target.serial ? rest.rfind('@') : rest.rfind(':');
  target.name = rest.substr(0, split);
  if (split != std::string::npos) target.number = number_in(rest.substr(split + 1));
  const bool baud =
      std::any_of(kBauds.begin(), kBauds.end(), [&](const Baud& one) { return one.number == target.number; });
  const bool port = target.number >= 1 && target.number <= kLargestPort && split != std::string::npos;
  const bool valid = target.serial ? baud : text.starts_with("tcp:") && port;
  if (valid && !target.name.empty()) return target;
  throw InputError(fmt::format(
      "{} {}: must be serial:PATH, serial:PATH@BAUD (9600 to 921600) or tcp:HOST:PORT", who, excerpt(text)));
}

Markers::Markers(const std::vector<MarkerTarget>& targets) {
  for (const MarkerTarget& target : targets) ports_.push_back(std::make_unique<Port>(target));
  thread_ = std::thread([this] { run(); });
}

Markers::~Markers() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Markers::begin_block(double rate_Hz) {
  period_ns_ = 1e9 / rate_Hz;
  first_tick_ = 0;
  const std::lock_guard lock(mutex_);
  report_ = {};
}

std::int64_t Markers::time_of(std::uint64_t tick) const noexcept {
  return first_tick_.load(std::memory_order_relaxed) +
         std::llround(static_cast<double>(tick) * period_ns_.load(std::memory_order_relaxed));
}

void Markers::note_tick(std::uint64_t tick, std::int64_t due) noexcept {
  const auto since = std::llround(static_cast<double>(tick) * period_ns_.load(std::memory_order_relaxed));
  first_tick_.store(due - since, std::memory_order_relaxed);
}

void Markers::send(Marker marker) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(marker));
  }
  changed_.notify_all();
}

Markers::Report Markers::finish_block() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.empty(); });
  return report_;
}

std::string Markers::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

bool Markers::write_all(const Marker& marker, std::int64_t due) {
  const nlohmann::ordered_json json{{"marker", static_cast<int>(marker.code)},
                                    {"event", name_of(marker.code)},
                                    {"session", marker.session},
                                    {"block", marker.block},
                                    {"task", marker.task},
                                    {"trial", marker.number},
                                    {"practice", marker.practice},
                                    {"tick", marker.tick},
                                    {"unix_ns", wall_time_of(due)}};
  const std::string line = json.dump() + '\n';
  bool complete = true;
  for (const std::unique_ptr<Port>& port : ports_) {
    const std::string why = port->write(line, static_cast<std::uint8_t>(marker.code));
    if (why.empty()) continue;
    complete = false;
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = port->target.text + ": " + why;
  }
  return complete;
}

void Markers::run() {
  // Below the loop, which may have a core of its own; without permission the markers are a little later.
  static_cast<void>(realtime::request_priority(realtime::Urgency::kLoop));
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Marker marker = waiting_.front();
    lock.unlock();
    std::int64_t due = time_of(marker.tick);
    for (; monotonic_ns() < due; due = time_of(marker.tick)) sleep_until_ns(due);  // a late tick may move it
    const bool complete = write_all(marker, due);
    const std::int64_t late = monotonic_ns() - due;
    lock.lock();
    ++(complete ? report_.sent : report_.lost);
    report_.worst_late = std::max(report_.worst_late, late);
    waiting_.pop_front();
    changed_.notify_all();
  }
}

}  // namespace palpate::study
