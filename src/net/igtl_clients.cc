#include "net/igtl_clients.h"

#include <algorithm>
#include <cerrno>

#include <poll.h>
#include <sys/socket.h>

#include "io/system/clock.h"

namespace palpate::net {
namespace {

/// Size of each client's send buffer in the system. A larger buffer would only make the data older that a
/// slow client receives.
constexpr int kSendBuffer = 128 * 1024;  // bytes
constexpr std::size_t kMaxReadAtOnce = std::size_t{64} * 1024;

}  // namespace

IgtlClients::IgtlClients(const IgtlAddress& address, const Limits& limits)
    : limits_(limits), listener_(listen_at(address)), port_(port_of(listener_)) {}

bool IgtlClients::busy() const noexcept {
  return std::any_of(clients_.begin(), clients_.end(), [](const Client& client) { return client.busy(); });
}

void IgtlClients::let_in() {
  for (;;) {
    Descriptor socket = accept_from(listener_, kSendBuffer);
    if (socket.number() < 0) return;
    if (clients_.size() >= limits_.most_clients) {
      ++statistics_.refused;
      continue;
    }
    clients_.emplace_back(std::move(socket));
    ++statistics_.clients;
  }
}

/// Reads and discards at most kMaxReadAtOnce bytes. TCP flow control slows a client that sends without end.
void IgtlClients::discard_input(Client& client) {
  std::array<unsigned char, kMaxReadAtOnce> received;
  if (!client.talks) return;
  const ssize_t got = recv(client.socket.number(), received.data(), received.size(), MSG_DONTWAIT);
  if (got > 0) recognise(client, std::span(received).first(static_cast<std::size_t>(got)));
  if (got == 0) client.talks = false;  // the client has ended its sending side; it may still receive
  if (got < 0 && errno != EAGAIN && errno != EINTR) client.gone = true;
}

void IgtlClients::recognise(Client& client, std::span<const unsigned char> received) {
  constexpr std::array<unsigned char, 12> kStatus = {'S', 'T', 'A', 'T', 'U', 'S'};
  const std::size_t wanted = std::min(received.size(), kHeadBytes - client.head_bytes);
  if (wanted == 0) return;
  std::copy_n(received.begin(), wanted, client.head.begin() + static_cast<std::ptrdiff_t>(client.head_bytes));
  client.head_bytes += wanted;
  if (client.head_bytes < kHeadBytes) return;
  const auto type = client.head.begin() + 2;
  const auto name = type + kStatus.size();
  client.is_slicer = std::equal(kStatus.begin(), kStatus.end(), type) &&
                     std::all_of(name, client.head.end(), [](unsigned char letter) { return letter == 0; });
}

void IgtlClients::poll() {
  let_in();
  const std::int64_t now = monotonic_ns();
  for (Client& client : clients_) {
    discard_input(client);
    if (client.gone || !client.busy() || now - client.last_progress_ns <= limits_.send_timeout_ns) continue;
    client.gone = true;
    ++statistics_.given_up;
  }
  remove_closed();
}

void IgtlClients::remove_closed() {
  clients_.erase(
      std::remove_if(clients_.begin(), clients_.end(), [](const Client& client) { return client.gone; }),
      clients_.end());
}

void IgtlClients::send_on(Client& client) {
  while (client.busy()) {
    const ssize_t sent = send(client.socket.number(), client.pending.data() + client.sent,
                              client.pending.size() - client.sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      client.gone = errno != EAGAIN;
      return;
    }
    client.sent += static_cast<std::size_t>(sent);
    client.last_progress_ns = monotonic_ns();
  }
}

void IgtlClients::fill(Client& client, const IgtlChannels& channels) {
  client.pending.clear();
  client.sent = 0;
  client.last_progress_ns = monotonic_ns();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const IgtlChannel& channel = channels[i];
    if (channel.number == client.had[i] || (i == kSensorChannel && client.is_slicer)) continue;
    if (i == kPoseChannel) {
      ++statistics_.frames;
      if (client.had[i] != 0) statistics_.frames_left_out += channel.number - client.had[i] - 1;
    }
    client.had[i] = channel.number;
    client.pending.insert(client.pending.end(), channel.bytes.begin(), channel.bytes.end());
  }
}

void IgtlClients::offer(const IgtlChannels& channels) {
  for (Client& client : clients_) {
    if (client.busy()) continue;
    fill(client, channels);
    send_on(client);
  }
  remove_closed();
}

void IgtlClients::send_until(std::int64_t deadline_ns, int wake) {
  std::vector<pollfd> waited_for;
  for (;;) {
    waited_for.assign(1, {wake, POLLIN, 0});
    for (const Client& client : clients_) {
      // poll() ignores a negative descriptor.
      waited_for.push_back({client.busy() ? client.socket.number() : -1, POLLOUT, 0});
    }
    const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
    const timespec limit{left / 1'000'000'000, left % 1'000'000'000};
    const int ready = ppoll(waited_for.data(), waited_for.size(), &limit, nullptr);
    for (std::size_t i = 0; ready > 0 && i < clients_.size(); ++i) {
      if (waited_for[i + 1].revents != 0) send_on(clients_[i]);
    }
    remove_closed();
    if (left == 0 || (ready > 0 && waited_for[0].revents != 0)) return;
  }
}

/// Closes all connections. Closing a connection with unread input would reset it, and data under way would be
/// lost. So each input is read first.
void IgtlClients::close_all() {
  listener_ = Descriptor(-1);
  for (Client& client : clients_) {
    (void)shutdown(client.socket.number(), SHUT_WR);
    discard_input(client);
  }
  clients_.clear();
}

}  // namespace palpate::net
