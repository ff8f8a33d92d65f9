#include "net/igtl_clients.h"

#include <algorithm>

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
    Socket socket = accept_from(listener_, kSendBuffer);
    if (!socket.is_open()) return;
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
  const Transfer got = receive_from(client.socket, received);
  recognise(client, std::span(received).first(got.bytes));
  if (got.ended) client.talks = false;
  if (!got.broken.empty()) client.gone = true;
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
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
}

void IgtlClients::send_on(Client& client) {
  while (client.busy()) {
    const Transfer sent = send_to(client.socket, std::span(client.pending).subspan(client.sent));
    client.gone = !sent.broken.empty();
    if (sent.bytes == 0) return;
    client.sent += sent.bytes;
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

void IgtlClients::send_until(std::int64_t deadline_ns) {
  std::vector<Awaited> busy;
  do {
    busy.clear();
    for (const Client& client : clients_) {
      if (client.busy()) busy.push_back({client.socket, true});
    }
    wait_for(busy, deadline_ns);
    for (Client& client : clients_) send_on(client);
    remove_closed();
  } while (monotonic_ns() < deadline_ns);
}

/// Closes all connections. Closing a connection with unread input would reset it, and data under way would be
/// lost. So each input is read first.
void IgtlClients::close_all() {
  listener_ = Socket();
  for (Client& client : clients_) {
    end_sending(client.socket);
    discard_input(client);
  }
  clients_.clear();
}

}  // namespace palpate::net
