#include "run/devices/igtl.h"

#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "io/system/clock.h"
#include "palpate/error.h"
#include "run/realtime/realtime.h"

namespace palpate::devices {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;             // ns
constexpr std::int64_t kOpeningPoll = 5 * kMillisecond;      // ns between two looks for the first poses
constexpr std::int64_t kFarewellLimit = 200 * kMillisecond;  // ns for the last zero force
constexpr int kIgtlSendBuffer = 16 * 1024;                   // bytes: some 50 periods
constexpr std::size_t kMaxReceived = std::size_t{64} * 1024;

const char* const kWho = "device igtl:";

std::int64_t in_ms(std::int64_t ns) { return ns / kMillisecond; }

}  // namespace

IgtlSource parse_igtl_source(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) {
    throw InputError(fmt::format(
        "{} \"{}\": must be PORT/NAME or ADDRESS:PORT/NAME, as in igtl:18945/Hand: the port at which the "
        "client connects, and the name of its TRANSFORM messages",
        kWho, text));
  }
  IgtlSource source{net::parse_igtl_address(text.substr(0, slash), kWho), text.substr(slash + 1)};
  const std::string& name = source.name;
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) { return c > 0x20 && c < 0x7f; });
  if (name.empty() || name.size() > net::IgtlReader::kLongestName || !plain) {
    throw InputError(fmt::format("{} name \"{}\": must have 1 to {} printable ASCII characters", kWho, name,
                                 net::IgtlReader::kLongestName));
  }
  return source;
}

IgtlDevice::IgtlDevice(const std::string& source, const IgtlTimes& times, const OnWait& on_wait)
    : IgtlDevice(parse_igtl_source(source), times) {
  wait_for_poses(on_wait);
}

IgtlDevice::IgtlDevice(IgtlSource source, const IgtlTimes& times)
    : times_(times),
      source_(std::move(source)),
      listener_(net::listen_at(source_.address, kWho)),
      reader_(source_.name) {
  const realtime::BlockedSignals signals;
  thread_ = std::thread([this] { run(); });
}

IgtlDevice::~IgtlDevice() {
  closing_.store(true);
  thread_.join();
}

haptics::DeviceState IgtlDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  return poses_.at(monotonic_ns());
}

bool IgtlDevice::write(const haptics::ForceCommand& command_D) noexcept { return forces_.write(command_D); }

void IgtlDevice::stop() noexcept { forces_.stop(); }

std::string IgtlDevice::last_error() const {
  const std::int64_t heard = heard_ns_.load();
  const std::int64_t silence = monotonic_ns() - heard;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!usable_ || silence <= PoseStream::kSilence) return last_error_;
  return fmt::format("{}: no TRANSFORM {} came for {} ms", source_.address.text(), source_.name,
                     in_ms(silence));
}

std::string IgtlDevice::description() const {
  return fmt::format("TRANSFORM {} at {}", source_.name, source_.address.text());
}

void IgtlDevice::wait_for_poses(const OnWait& on_wait) {
  const std::int64_t deadline = monotonic_ns() + times_.opening;
  for (;;) {
    const std::int64_t now = monotonic_ns();
    const haptics::DeviceState sample = poses_.at(now);
    if (sample.fault == haptics::Fault::kNone && sample.age == 0.0) return;
    if (now >= deadline) throw InputError(why_no_poses());
    if (on_wait) on_wait();
    sleep_until_ns(std::min(deadline, now + kOpeningPoll));
  }
}

std::string IgtlDevice::why_no_poses() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string why;
  if (!last_error_.empty()) {
    why = "; the last error: " + last_error_;
  } else if (!connected_) {
    why = ": none has connected";
  } else if (heard_ns_.load() > 0) {
    why = fmt::format(": its messages must come at least every {} ms", in_ms(PoseStream::kSilence));
  } else if (others_.empty()) {
    why = ": it sends no TRANSFORM";
  } else {
    why = fmt::format(": it sends {}", fmt::join(others_, ", "));
  }
  return fmt::format("{} no client sent poses as TRANSFORM {} to {} within {:.3g} s{}", kWho, source_.name,
                     source_.address.text(), 1e-9 * static_cast<double>(times_.opening), why);
}

void IgtlDevice::run() noexcept {
  while (!closing_.load()) {
    try {
      serve();
    } catch (const std::exception& error) {
      drop(error.what());
    }
  }
  let_go();
}

/// Waits for bytes from the client or the next message to it, and handles them.
void IgtlDevice::serve() {
  const std::array<net::Awaited, 2> awaited = {{{listener_}, {client_}}};
  net::wait_for(awaited, next_send_ns_);
  const std::int64_t now = monotonic_ns();
  let_in(now);
  receive(now);
  send_if_due(now);
}

void IgtlDevice::let_in(std::int64_t now) {
  for (;;) {
    net::Socket socket = net::accept_from(listener_, kIgtlSendBuffer);
    if (!socket.is_open()) return;
    receive(now);  // the present client may have closed its connection before
    if (client_.is_open()) {
      if (now - received_ns_ <= times_.replaced) continue;  // closes the new connection
      drop("another client has replaced one that sent nothing");
    }
    client_ = std::move(socket);
    reader_ = net::IgtlReader(source_.name);
    received_ns_ = now;
    const std::lock_guard<std::mutex> lock(mutex_);
    connected_ = true;
    others_.clear();
  }
}

void IgtlDevice::receive(std::int64_t now) {
  if (!client_.is_open()) return;
  std::array<unsigned char, kMaxReceived> bytes;
  const net::Transfer got = net::receive_from(client_, bytes);
  if (!got.broken.empty()) return drop("the connection broke: " + got.broken);
  if (got.ended) return drop("the client closed the connection");
  if (got.bytes == 0) return;
  received_ns_ = now;
  try {
    reader_.read(
        std::span(bytes).first(got.bytes),
        [this, now](const std::optional<Pose>& pose, const std::string& status) { take(pose, status, now); });
  } catch (const InputError& error) {
    return drop(std::string(error.what()) + "; the client was disconnected");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (others_.size() != reader_.others().size()) others_ = reader_.others();
}

void IgtlDevice::take(const std::optional<Pose>& pose, const std::string& status, std::int64_t now) {
  if (!status.empty()) return set_error("TRANSFORM " + source_.name + ": no pose, its " + status);
  heard_ns_.store(now);
  if (!pose) {
    set_error("TRANSFORM " + source_.name + ": its matrix is not finite, or scales, shears or mirrors");
    return poses_.break_off();
  }
  const std::string refused = poses_.add({pose->position, pose->rotation}, now);
  if (!refused.empty()) return set_error("TRANSFORM " + source_.name + ": " + refused);
  const std::lock_guard<std::mutex> lock(mutex_);
  usable_ = true;
}

void IgtlDevice::send_if_due(std::int64_t now) {
  if (now < next_send_ns_) return;
  next_send_ns_ = now + times_.period;
  if (!client_.is_open()) return;
  if (sent_ == pending_.size()) pack(forces_.wanted(now, times_.write_timeout));
  send_pending();
}

/// The command as messages. Only clients other than 3D Slicer, which cannot read them, get SENSOR messages.
void IgtlDevice::pack(const haptics::ForceCommand& command_D) {
  net::IgtlMessages messages(unix_ns());
  messages.add_transform(kForceName, {Quat::Identity(), 1e-3 * command_D.force});
  if (!reader_.is_slicer()) {
    messages.add_sensor(kForceName, command_D.force, net::SensorUnit::kNewton);
    messages.add_sensor(kTorqueName, command_D.torque, net::SensorUnit::kNewtonMetre);
  }
  pending_ = messages.bytes();
  sent_ = 0;
}

/// Sends what the system takes. A client that reads too slowly gets the newest command after the present one.
void IgtlDevice::send_pending() {
  while (sent_ < pending_.size()) {
    const net::Transfer sent = net::send_to(client_, std::span(pending_).subspan(sent_));
    if (!sent.broken.empty()) return drop("the connection broke: " + sent.broken);
    if (sent.bytes == 0) return;
    sent_ += sent.bytes;
  }
}

/// Ends the connection, which is a fault.
void IgtlDevice::drop(const std::string& why) {
  set_error(why);
  poses_.break_off();
  client_ = net::Socket();
  pending_.clear();
  sent_ = 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  connected_ = false;
}

/// Sends a zero force at the end, whatever became of the last command.
void IgtlDevice::let_go() noexcept {
  try {
    const std::int64_t deadline = monotonic_ns() + kFarewellLimit;
    for (bool zero = false; client_.is_open() && monotonic_ns() < deadline;) {
      send_pending();
      if (sent_ < pending_.size()) {
        sleep_until_ns(monotonic_ns() + kMillisecond);
      } else if (zero) {
        break;
      } else {
        pack({});
        zero = true;
      }
    }
    // Closing a connection with unread input would reset it, and the zero force could be lost.
    if (!client_.is_open()) return;
    net::end_sending(client_);
    std::array<unsigned char, kMaxReceived> ignored;
    while (monotonic_ns() < deadline) {
      if (net::receive_from(client_, ignored).bytes == 0) break;
    }
  } catch (const std::exception&) {
    return;  // no memory is left for a message; the connection is closed
  }
}

void IgtlDevice::set_error(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_error_ = source_.address.text() + ": " + what;
  usable_ = false;
}

}  // namespace palpate::devices
