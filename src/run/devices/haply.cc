#include "run/devices/haply.h"

#include <algorithm>
#include <charconv>
#include <exception>
#include <string_view>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/clock.h"
#include "palpate/error.h"
#include "run/realtime/realtime.h"

namespace palpate::devices {
namespace {

constexpr std::int64_t kShutdownLimit =
    200'000'000;                                 // ns for the last zero force, and again for closing the link
constexpr std::int64_t kPollPeriod = 5'000'000;  // ns between two checks for the end, during a pause

const char* const kKind = "haply";
const char* const kHowToStart =
    " (start Haply's Inverse Service, or give its address with --device haply:ws://HOST:PORT)";

/// Waits for the first message after the handshake. @throws websocket::Error when none comes in time
std::string first_message(websocket::Client& link, std::int64_t limit_ns, const std::atomic<bool>& give_up) {
  const std::int64_t deadline = monotonic_ns() + limit_ns;
  for (;;) {
    if (std::optional<std::string> message = link.received()) return *std::move(message);
    const std::int64_t now = monotonic_ns();
    if (now >= deadline) {
      throw websocket::Error(
          fmt::format("the service sent nothing within {} ms of the handshake", limit_ns / 1'000'000));
    }
    if (give_up.load(std::memory_order_relaxed)) throw websocket::Error("given up");
    link.wait_until(std::min(deadline, now + kPollPeriod));
  }
}

std::string lacking(std::size_t place, const std::vector<std::string>& arms) {
  if (arms.empty()) return "the service has no Inverse3";
  return fmt::format("the service has no Inverse3 number {}, only {}", place + 1, joined(arms));
}

}  // namespace

websocket::Address parse_haply_address(const std::string& text) {
  const std::string given = text.empty() ? "ws://localhost:10001" : text;
  const auto refuse = [&](const std::string& want) {
    throw InputError(fmt::format(
        "device haply: address \"{}\": {}, must be ws://HOST:PORT, as in ws://localhost:10001", given, want));
  };
  constexpr std::string_view kScheme = "ws://";
  if (given.compare(0, kScheme.size(), kScheme) != 0) refuse("does not begin with ws://");
  std::string rest = given.substr(kScheme.size());
  if (!rest.empty() && rest.back() == '/') rest.pop_back();
  const std::size_t colon = rest.rfind(':');
  const std::size_t bracket = rest.find(']');
  if (colon == std::string::npos || (bracket != std::string::npos && colon < bracket)) refuse("has no port");
  websocket::Address address{rest.substr(0, colon), rest.substr(colon + 1)};
  unsigned port = 0;
  const char* end = address.port.data() + address.port.size();
  const auto [read_to, error] = std::from_chars(address.port.data(), end, port);
  if (error != std::errc() || read_to != end || port < 1 || port > 65535) {
    refuse("its port is no number from 1 to 65535");
  }
  std::string& host = address.host;
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
    if (host.find(':') == std::string::npos) refuse("has a name in brackets");
  } else if (host.find(':') != std::string::npos) {
    refuse("has a colon in its host");
  }
  const bool plain = std::all_of(host.begin(), host.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view(".-_:%").find(c) != std::string_view::npos;
  });
  if (host.empty() || !plain) refuse("has no host");
  return address;
}

HaplyDevice::HaplyDevice(const std::string& address, std::size_t place, const HaplyTimes& times) try
    : times_(times), address_(parse_haply_address(address)), link_(address_, closing_) {
  try {
    link_.open(times_.opening);
  } catch (const websocket::Error& error) {
    throw InputError("device haply: no service at " + address_.text() + ": " + error.what() + kHowToStart);
  }
  try {
    greet(place);
  } catch (const std::exception& error) {
    throw InputError(fmt::format("device haply: {}: {}", address_.text(), error.what()));
  }
  const realtime::BlockedSignals signals;
  thread_ = std::thread([this] { run(); });
} catch (const websocket::Error& error) {  // thrown by the link's constructor, as for an unknown host
  throw InputError(fmt::format("device haply: {}: {}", parse_haply_address(address).text(), error.what()));
}

HaplyDevice::~HaplyDevice() {
  closing_.store(true);
  thread_.join();
}

haptics::DeviceState HaplyDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  samples_.refresh();
  const Sample& newest = samples_.value();
  haptics::DeviceState state = newest.state;
  state.age = 1e-9 * static_cast<double>(std::max<std::int64_t>(0, monotonic_ns() - newest.received_ns));
  return state;
}

bool HaplyDevice::write(const haptics::ForceCommand& command_D) noexcept { return forces_.write(command_D); }

void HaplyDevice::stop() noexcept { forces_.stop(); }

std::string HaplyDevice::last_error() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_error_;
}

std::string HaplyDevice::description() const {
  return "Inverse3 " + arm_ + (grip_.empty() ? "" : " with verse grip " + grip_) + " at " + address_.text();
}

/// Takes the first message. At the first connection it assigns the arm. After a reconnection it must contain
/// that arm.
void HaplyDevice::greet(std::size_t place) {
  const std::string message = first_message(link_, times_.opening, closing_);
  const HaplyInventory inventory = read_haply_inventory(message);
  if (arm_.empty()) {
    if (place >= inventory.arms.size()) throw websocket::Error(lacking(place, inventory.arms));
    arm_ = inventory.arms[place];
    if (place < inventory.grips.size()) grip_ = inventory.grips[place];
  }
  force_field_ = inventory.force_field;
  const HaplySample first = read_haply_state(message, arm_, grip_);
  if (!first.off.empty()) set_error(fmt::format("Inverse3 {}: {}", arm_, first.off));
  publish(first.state, monotonic_ns());
}

void HaplyDevice::run() noexcept {
  while (!closing_.load()) {
    try {
      if (!link_.is_open()) {
        link_.open(times_.opening);
        greet(0);
      }
      exchange();
    } catch (const std::exception& error) {
      link_.drop();
      if (closing_.load()) return;
      fail(error.what());
      pause();
    }
  }
  let_go();
}

/// Exchanges commands and replies until the device is closed. @throws websocket::Error when the connection
/// ends
void HaplyDevice::exchange() {
  Exchange now;
  while (!closing_.load()) {
    take_replies(now);
    send_if_due(now);
    // A received or sent message ends the wait. The time limit lets this thread notice stop() and a loop that
    // no longer writes.
    const bool may_send = now.awaited == 0 && !link_.sending();
    link_.wait_until(may_send ? now.next_send_ns : monotonic_ns() + times_.period);
  }
}

void HaplyDevice::take_replies(Exchange& exchange) {
  const std::optional<std::string> message = link_.received();
  const std::int64_t now = monotonic_ns();
  if (message) {
    take(*message, now);
    exchange.awaited = std::max<std::int64_t>(0, exchange.awaited - 1);
    exchange.waiting_since_ns = now;
  } else if (exchange.awaited > 0 && now - exchange.waiting_since_ns > times_.reply) {
    throw websocket::Error(fmt::format("the service gave no reply for {} ms", times_.reply / 1'000'000));
  }
}

void HaplyDevice::send_if_due(Exchange& exchange) {
  const std::int64_t now = monotonic_ns();
  const Vec3 force_D = forces_.wanted(now, times_.write_timeout).force;
  const bool releases = force_D.isZero(0.0) && !exchange.sent_D.isZero(0.0);
  const bool due = exchange.awaited == 0 && now >= exchange.next_send_ns;
  if (link_.sending() || !(due || releases)) return;
  link_.send(haply_force_command(arm_, force_D, force_field_));
  if (exchange.awaited == 0) exchange.waiting_since_ns = now;
  ++exchange.awaited;
  exchange.sent_D = force_D;
  exchange.next_send_ns = now + times_.period;
}

void HaplyDevice::take(const std::string& message, std::int64_t now) {
  try {
    const HaplySample sample = read_haply_state(message, arm_, grip_);
    if (!sample.off.empty()) set_error(fmt::format("Inverse3 {}: {}", arm_, sample.off));
    publish(sample.state, now);
  } catch (const InputError& error) {
    fail(error.what());
  }
}

void HaplyDevice::publish(const haptics::DeviceState& state, std::int64_t received_ns) {
  newest_ = {state, received_ns};
  samples_.writable() = newest_;
  samples_.publish();
}

/// Publishes the newest good sample again, marked as unreadable (Fault::kDevice).
void HaplyDevice::fail(const std::string& why) {
  set_error(why);
  haptics::DeviceState state = newest_.state;
  state.fault = haptics::Fault::kDevice;
  publish(state, newest_.received_ns);
}

void HaplyDevice::set_error(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_error_ = address_.text() + ": " + what;
}

/// Waits until the next attempt to connect.
void HaplyDevice::pause() const noexcept {
  const std::int64_t end = monotonic_ns() + times_.retry;
  for (std::int64_t now = monotonic_ns(); now < end && !closing_.load(); now = monotonic_ns()) {
    sleep_until_ns(std::min(end, now + kPollPeriod));
  }
}

/// Sends a zero force and closes the link, whatever became of the last command.
void HaplyDevice::let_go() noexcept {
  if (!link_.is_open()) return;
  try {
    const std::int64_t deadline = monotonic_ns() + kShutdownLimit;
    while (link_.sending() && monotonic_ns() < deadline) link_.wait_until(deadline);
    if (!link_.sending()) link_.send(haply_force_command(arm_, Vec3::Zero(), force_field_));
  } catch (const std::exception&) {
    return;  // the connection has ended; the service releases an arm that has no client
  }
  link_.close(kShutdownLimit);
}

Probe probe_haply(const std::string& address) {
  const std::atomic<bool> never{false};
  std::string where;
  try {
    const websocket::Address parsed = parse_haply_address(address);
    where = parsed.text();
    websocket::Client link(parsed, never);
    link.open();
    const HaplyInventory found =
        read_haply_inventory(first_message(link, websocket::Client::kOpeningLimit, never));
    link.close(kShutdownLimit);
    if (found.arms.empty()) return {kKind, false, "the service at " + where + " has no Inverse3"};
    const std::string grips = found.grips.empty() ? "no verse grip" : "verse grip " + joined(found.grips);
    return {kKind, true, fmt::format("at {}: Inverse3 {}; {}", where, joined(found.arms), grips)};
  } catch (const websocket::Error& error) {
    return {kKind, false, fmt::format("no service at {}: {}{}", where, error.what(), kHowToStart)};
  } catch (const InputError& error) {
    return {kKind, false, (where.empty() ? "" : "at " + where + ": ") + std::string(error.what())};
  }
}

}  // namespace palpate::devices
