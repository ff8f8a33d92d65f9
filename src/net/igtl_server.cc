#include "net/igtl_server.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "io/system/clock.h"
#include "run/realtime/realtime.h"

namespace palpate::net {
namespace {

constexpr std::int64_t period_ns(double rate_Hz) { return static_cast<std::int64_t>(1e9 / rate_Hz); }

/// Packing surfaces takes at most 1/kShareOfSurface of the thread's time.
constexpr std::int64_t kShareOfSurface = 4;

}  // namespace

IgtlServer::IgtlServer(const IgtlAddress& address, const IgtlClients::Limits& limits)
    : clients_(address, limits) {
  const realtime::BlockedSignals held;
  thread_ = std::thread([this] { serve(); });
}

IgtlServer::~IgtlServer() {
  if (thread_.joinable()) (void)finish();
}

void IgtlServer::begin(std::unique_ptr<IgtlStream> stream) { ask(Ask::kBegin, std::move(stream)); }

void IgtlServer::end() { ask(Ask::kEnd, nullptr); }

IgtlStatistics IgtlServer::finish() {
  ask(Ask::kFinish, nullptr);
  thread_.join();
  IgtlStatistics tally = clients_.statistics();
  tally.failure = failure_;
  return tally;
}

/// Passes a request to the server's thread and waits until the thread has answered it, which takes as long as
/// the wait for its next frame.
void IgtlServer::ask(Ask what, std::unique_ptr<IgtlStream> stream) {
  std::unique_lock lock(mutex_);
  if (!serving_) return;
  asked_ = what;
  next_ = std::move(stream);
  answered_.wait(lock, [this] { return asked_ == Ask::kNothing || !serving_; });
}

void IgtlServer::answer() {
  const std::lock_guard lock(mutex_);
  asked_ = Ask::kNothing;
  answered_.notify_all();
}

void IgtlServer::serve() {
  realtime::yield_to_loop();
  try {
    serve_until_finish();
  } catch (const std::exception& error) {
    failure_ = error.what();
  }
  clients_.close_all();
  const std::lock_guard lock(mutex_);
  serving_ = false;
  answered_.notify_all();
}

void IgtlServer::serve_until_finish() {
  std::int64_t due = monotonic_ns();
  for (;;) {
    clients_.send_until(due);
    Ask asked{};
    std::unique_ptr<IgtlStream> next;
    {
      const std::lock_guard lock(mutex_);
      asked = asked_;
      next = std::move(next_);
    }
    const std::int64_t now = monotonic_ns();
    if (asked == Ask::kFinish) return send_goodbye();
    if (asked == Ask::kBegin) begin_stream(std::move(next));
    if (asked == Ask::kEnd || now >= due) frame(now, asked == Ask::kEnd);
    if (asked == Ask::kEnd) stream_.reset();
    if (asked != Ask::kNothing) answer();
    if (now >= due) due = std::max(due + period_ns(kStateRate), now);
  }
}

/// Begins the stream of a run. It first takes the previous run's last snapshot out of the triple buffer, so
/// that the new stream does not send it.
void IgtlServer::begin_stream(std::unique_ptr<IgtlStream> stream) {
  (void)published_.cell().refresh();
  stream_ = std::move(stream);
  seen_ = false;
  state_stale_ = false;
  surface_stale_ = false;
  sent_faults_ = {};
  for (IgtlChannel& channel : channels_) channel.bytes.clear();
  status_due_ = 0;
  surface_due_ = 0;
}

void IgtlServer::frame(std::int64_t now, bool last) {
  if (stream_ != nullptr && published_.cell().refresh()) {
    seen_ = true;
    state_stale_ = true;
    surface_stale_ = true;
  }
  clients_.poll();
  if (clients_.none()) return;
  pack(now, last);
  clients_.offer(channels_);
}

/// Wall time of the current state [ns]. A state of an offline run has no wall time, so it gets the present
/// time.
std::int64_t IgtlServer::stamp() const noexcept {
  const std::int64_t taken = published_.cell().value().taken_ns;
  return taken == 0 ? unix_ns() : wall_time_of(taken);
}

bool IgtlServer::faults_changed() noexcept {
  const bool changed = published_.cell().value().faults != sent_faults_;
  sent_faults_ = published_.cell().value().faults;
  return changed;
}

void IgtlServer::send_next(std::size_t channel, Bytes bytes) {
  channels_[channel] = {std::move(bytes), channels_[channel].number + 1};
}

void IgtlServer::pack(std::int64_t now, bool last) {
  const bool running = stream_ != nullptr && seen_;
  const haptics::Snapshot& snapshot = published_.cell().value();
  const std::int64_t taken = running ? stamp() : unix_ns();
  if (running && std::exchange(state_stale_, false)) {
    send_next(kPoseChannel, stream_->poses(snapshot, taken));
    send_next(kSensorChannel, stream_->sensors(snapshot, taken));
  }
  if (last || now >= status_due_ || (running && faults_changed())) {
    status_due_ = now + period_ns(kStatusRate);
    send_next(kStatusChannel, running ? stream_->status(snapshot, taken) : status_without_run(false, taken));
  }
  if (running && surface_stale_ && (last || now >= surface_due_)) pack_surface(now, taken);
}

void IgtlServer::pack_surface(std::int64_t now, std::int64_t stamp) {
  surface_stale_ = false;
  const std::int64_t before = thread_cpu_ns();
  Bytes bytes = stream_->surface(published_.cell().value(), stamp);
  surface_due_ = now + std::max(period_ns(kSurfaceRate), kShareOfSurface * (thread_cpu_ns() - before));
  if (!bytes.empty()) send_next(kSurfaceChannel, std::move(bytes));
}

/// Sends the data that clients have not received yet, and a last status that palpate ends.
void IgtlServer::send_goodbye() {
  send_next(kStatusChannel, status_without_run(true, unix_ns()));
  const std::int64_t until = monotonic_ns() + kShutdownTime;
  clients_.poll();
  clients_.offer(channels_);
  while (clients_.busy() && monotonic_ns() < until) {
    clients_.send_until(monotonic_ns() + period_ns(kStateRate));
    clients_.offer(channels_);
  }
}

IgtlRun::IgtlRun(IgtlServer* server, const scene::Scene& scene) : server_(server) {
  if (server_ != nullptr) server_->begin(std::make_unique<IgtlStream>(scene));
}

IgtlRun::~IgtlRun() {
  if (server_ != nullptr) server_->end();
}

}  // namespace palpate::net
