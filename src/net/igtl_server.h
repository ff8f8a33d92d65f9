#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>

#include "net/igtl_clients.h"
#include "net/igtl_stream.h"
#include "palpate/tick_observer.h"

namespace palpate::net {

/// Shows a run to OpenIGTLink clients, from a thread of its own. It observes the loop, which knows nothing of
/// clients; nobody waits for one. Without clients nothing is packed.
class IgtlServer final : public haptics::TickObserver {
 public:
  static constexpr double kStateRate = 50.0;    // Hz, at most: poses and sensors
  static constexpr double kWordsRate = 5.0;     // Hz; a new fault is told with the next state
  static constexpr double kSurfaceRate = 10.0;  // Hz, at most; a large organ's is lower

  /// [setup] Listens from here on. @throws InputError as IgtlClients
  explicit IgtlServer(const IgtlAddress& address, const IgtlClients::Limits& limits = {});
  ~IgtlServer() override;
  IgtlServer(const IgtlServer&) = delete;
  IgtlServer& operator=(const IgtlServer&) = delete;

  [[nodiscard]] int port() const noexcept { return clients_.port(); }

  /// [setup] What is sent from here on; before the loop begins. One run after the other.
  void begin(std::unique_ptr<IgtlStream> stream);
  /// [setup] After the loop has ended: its last state still goes to every client that can take it.
  void end();
  /// [rt] The loop hands its state over.
  void on_tick(const haptics::TickState& now) noexcept override { published_.on_tick(now); }
  /// [rt] The same with a snapshot that is made already.
  void publish(const haptics::Snapshot& snapshot) noexcept {
    published_.cell().writable() = snapshot;
    published_.cell().publish();
  }

  /// [setup] Says good-bye to all clients and ends. Once. @return how it went
  [[nodiscard]] IgtlTally finish();

 private:
  enum class Ask { kNothing, kBegin, kEnd, kFinish };
  static constexpr std::int64_t kFarewell = 1'000'000'000;  // ns, for clients to take what was sent last

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
  Descriptor wake_;
  haptics::SnapshotPublisher published_;
  std::mutex mutex_;
  std::condition_variable answered_;
  Ask asked_ = Ask::kNothing;         // guarded by mutex_, as the next two
  std::unique_ptr<IgtlStream> next_;  // with kBegin
  bool serving_ = true;
  // The thread's own:
  std::unique_ptr<IgtlStream> stream_;  // null: no run
  IgtlChannels channels_;
  bool seen_ = false;           // a state of this run
  bool state_stale_ = false;    // a newer one has come than was packed
  bool surface_stale_ = false;  // likewise
  std::array<haptics::Fault, haptics::Snapshot::kMaxHands> faults_told_{};
  std::int64_t words_due_ = 0;
  std::int64_t surface_due_ = 0;
  std::string failure_;
  std::thread thread_;  // last: it uses all of the above
};

/// A run as a server shows it: from before the loop begins until after it has ended. [setup]
class IgtlRun final {
 public:
  /// @param server null: nothing is shown
  IgtlRun(IgtlServer* server, const scene::Scene& setup);
  ~IgtlRun();
  IgtlRun(const IgtlRun&) = delete;
  IgtlRun& operator=(const IgtlRun&) = delete;

 private:
  IgtlServer* server_;
};

}  // namespace palpate::net
