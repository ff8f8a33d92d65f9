#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "net/live_observer.h"
#include "net/live_server.h"
#include "net/live_surface.h"

#include "app/live_run.h"
#include "app/next_session.h"
#include "app/session.h"

namespace palpate::app {

/// How the runs of `palpate serve` are played.
struct ServedOptions {
  scene::Overrides request;          // of the first, and of every one that is started anew
  std::filesystem::path scenes;      // files that clients may name are below it; empty: none may be named
  std::filesystem::path recording;   // of the first run, the others get a number; empty: none
  std::optional<double> duration_s;  // of every run
  haptics::LoopThread thread;        // of every run's loop
  bool no_cache = false;
  bool stop_when_alone = false;  // the last client's leaving ends a run
  bool json = false;             // how the summaries of runs are printed
};

/// The runs of one `palpate serve`, one after the other, as its clients drive them. All members: [setup], the
/// server's thread.
class ServedRuns final : public net::RunService {
 public:
  /// @param first is not played yet
  ServedRuns(ServedOptions options, std::unique_ptr<Session> first);

  /// Ends a run as soon as that is set, before clients are let go: the hand comes first. It outlives this.
  void stop_with(const std::atomic<bool>& stop) noexcept { stop_ = &stop; }
  /// Plays the first session, recorded to the file that was asked for, also over one that is there.
  void begin_first();
  /// Zero force, recording closed; the run's summary is printed.
  void finish();
  /// Whether a fault was latched in any run; whether one could not be played or recorded.
  [[nodiscard]] bool fault() const noexcept { return fault_; }
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::uint64_t runs() const noexcept { return runs_; }

  std::optional<nlohmann::ordered_json> answer(const net::LiveCommand& command,
                                               const net::ClientRef& client) override;
  [[nodiscard]] nlohmann::ordered_json about_run() override;
  [[nodiscard]] net::LiveState newest() override;
  std::vector<net::Event> poll(std::size_t clients) override;

 private:
  using Answer = std::optional<nlohmann::ordered_json>;

  [[nodiscard]] bool running() const noexcept { return run_ != nullptr && !accounted_; }
  [[nodiscard]] const scene::Scene& setup() const;
  Answer describe() const;
  Answer surface(bool at_rest);
  Answer load(const net::Load& wanted, const net::ClientRef& client);
  Answer start(const net::ClientRef& client);
  Answer stop(const net::ClientRef& client);
  Answer set_tissue(const net::TissueEdit& edit);
  Answer set_noise(const net::NoiseEdit& edit);
  [[nodiscard]] scene::Overrides request_of(const net::Load& wanted) const;
  [[nodiscard]] std::string file_below(const std::string& key, const std::string& name) const;
  [[nodiscard]] std::filesystem::path next_recording() const;
  [[nodiscard]] bool is_loading() const noexcept;
  void require_no_loading() const;
  void break_off_loading(const std::string& why);
  void begin_first(std::filesystem::path recording);
  [[nodiscard]] std::string next_failure() const;
  void begin(std::unique_ptr<Session> session, std::filesystem::path recording);
  void poll_next();
  void account_for_run();
  void report_faults();
  void send_event(const std::string& event, nlohmann::ordered_json members);

  ServedOptions options_;
  std::unique_ptr<Session> first_;  // until one is played; without devices once another is to come
  std::unique_ptr<LiveRun<net::LiveObserver>> run_;  // the newest, also after its end
  bool accounted_ = false;                           // it has ended, and that was dealt with
  std::optional<net::LiveSurface> surface_;          // of the newest run's organ, once it was asked for
  std::int64_t moved_ns_ = 0;                        // when the next moved_ may be made
  nlohmann::ordered_json moved_;                     // of surface_: where it has moved to
  bool request_is_clients_ = false;  // options_.request is what a client loaded, not the command line's
  std::unique_ptr<NextSession> next_;
  bool next_is_clients_ = false;
  std::optional<net::ClientRef> next_client_;
  std::optional<scene::Overrides> load_next_;  // once next_, which is broken off, has ended: for next_client_
  std::vector<net::ClientRef> stop_clients_;
  model::TissueParameters tissue_;  // in force, or of the next run
  noise::NoiseSettings noise_;
  std::vector<net::Event> events_;
  const std::atomic<bool>* stop_ = nullptr;
  std::uint64_t runs_ = 0;
  bool had_clients_ = false;
  bool fault_ = false;
  bool failed_ = false;
};

/// [setup] Refuses devices that the window of `palpate run` feeds. @throws InputError
void require_windowless(const scene::Scene& setup);

}  // namespace palpate::app
