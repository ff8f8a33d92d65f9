#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>

#include "net/igtl_clients.h"
#include "net/igtl_stream.h"
#include "palpate/tick_observer.h"

namespace palpate::net {

/// Sends a run to OpenIGTLink clients from its own thread. It observes the loop; neither the loop nor the
/// server waits for a client. Without clients it packs no messages.
class IgtlServer final : public haptics::TickObserver {
 public:
  static constexpr double kStateRate = 50.0;    // Hz, at most: poses and sensors
  static constexpr double kStatusRate = 5.0;    // Hz; a new fault is sent with the next state
  static constexpr double kSurfaceRate = 10.0;  // Hz, at most; lower for a large organ

  /// [setup] Starts to listen. @throws InputError as IgtlClients
  explicit IgtlServer(const IgtlAddress& address, const IgtlClients::Limits& limits = {});
  ~IgtlServer() override;
  IgtlServer(const IgtlServer&) = delete;
  IgtlServer& operator=(const IgtlServer&) = delete;

  [[nodiscard]] int port() const noexcept { return clients_.port(); }

  /// [setup] Starts the stream of a run; call before the loop begins. One run at a time.
  void begin(std::unique_ptr<IgtlStream> stream);
  /// [setup] Ends the stream of a run; call after the loop has ended. Clients that are not busy get the last
  /// state.
  void end();
  /// [rt] Publishes the state of the loop.
  void on_tick(const haptics::TickState& now) noexcept override { published_.on_tick(now); }
  /// [rt] Publishes a snapshot.
  void publish(const haptics::Snapshot& snapshot) noexcept {
    published_.cell().writable() = snapshot;
    published_.cell().publish();
  }

  /// [setup] Notifies all clients, then ends the server. Call once. @return its statistics
  [[nodiscard]] IgtlStatistics finish();

 private:
  enum class Ask { kNothing, kBegin, kEnd, kFinish };
  static constexpr std::int64_t kShutdownTime =
      1'000'000'000;  // ns, time for clients to receive the last messages

  void ask(Ask what, std::unique_ptr<IgtlStream> stream);
  void answer();
  void serve();
  void serve_until_finish();
  void begin_stream(std::unique_ptr<IgtlStream> stream);
  void frame(std::int64_t now, bool last);
  void pack(std::int64_t now, bool last);
  void send_next(std::size_t channel, Bytes bytes);
  void pack_surface(std::int64_t now, std::int64_t stamp);
  void send_goodbye();
  [[nodiscard]] std::int64_t stamp() const noexcept;
  [[nodiscard]] bool faults_changed() noexcept;

  IgtlClients clients_;
  haptics::SnapshotPublisher published_;
  std::mutex mutex_;
  std::condition_variable answered_;
  Ask asked_ = Ask::kNothing;         // this and the next two: guarded by mutex_
  std::unique_ptr<IgtlStream> next_;  // with kBegin
  bool serving_ = true;
  // Used only by the thread:
  std::unique_ptr<IgtlStream> stream_;  // null: no run
  IgtlChannels channels_;
  bool seen_ = false;           // a state of this run was received
  bool state_stale_ = false;    // a newer state than the packed one was received
  bool surface_stale_ = false;  // a newer state than the packed surface was received
  std::array<haptics::Fault, kMaxHands> sent_faults_{};
  std::int64_t status_due_ = 0;
  std::int64_t surface_due_ = 0;
  std::string failure_;
  std::thread thread_;  // last: it uses all of the above
};

/// [setup] Calls begin() and end() of a server around a run.
class IgtlRun final {
 public:
  /// @param server null: nothing is sent
  IgtlRun(IgtlServer* server, const scene::Scene& scene);
  ~IgtlRun();
  IgtlRun(const IgtlRun&) = delete;
  IgtlRun& operator=(const IgtlRun&) = delete;

 private:
  IgtlServer* server_;
};

}  // namespace palpate::net
