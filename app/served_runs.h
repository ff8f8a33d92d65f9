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
#include "app/row_observer.h"
#include "app/run_tape.h"
#include "app/session.h"
#include "app/steered_hands.h"

namespace palpate::app {

/// Options of the runs of `palpate serve`.
struct ServedOptions {
  scene::Overrides request;          // scene of the first run and of every restart
  std::filesystem::path scenes;      // folder of the files that clients may load; empty: none
  std::filesystem::path recording;   // file of the first run, numbered for the later runs; empty: none
  std::optional<double> duration_s;  // simulated time of every run [s]
  haptics::LoopThread thread;        // thread of every run's haptic loop
  bool no_cache = false;
  bool stop_when_alone = false;  // the run ends when the last client disconnects
  bool page = false;  // clients are this user's page, which chooses devices, is a mouse and records
  bool json = false;  // print the summaries of runs as JSON
};

/// Observes a run for the streams of clients, and passes its rows on for a recording that begins later.
struct ServedObserver final : public haptics::TickObserver {
  ServedObserver(std::size_t hands, double rate_Hz) : live(hands, rate_Hz) {}
  void on_start(std::int64_t started_unix_ns) noexcept override { rows.on_start(started_unix_ns); }
  void on_update(const haptics::ParameterUpdate& update) noexcept override {
    live.on_update(update);
    rows.on_update(update);
  }
  void on_row(const haptics::TickRow& row) noexcept override {
    live.on_row(row);
    rows.on_row(row);
  }

  net::LiveObserver live;
  RowObserver rows;
};

/// The successive runs of one `palpate serve`, which its clients control. All members: [setup], the server's
/// thread.
class ServedRuns final : public net::RunService {
 public:
  /// @param first session of the command line; begin_first() or a client starts it
  ServedRuns(ServedOptions options, std::unique_ptr<Session> first);

  /// @param stop when it is set, the run ends before the clients are disconnected, so that the hand has zero
  /// force first; outlives this
  void stop_with(const std::atomic<bool>& stop) noexcept { stop_ = &stop; }
  /// Starts the first session and records it to the file of --record. Overwrites an existing file.
  void begin_first();
  /// Ends the run with zero force and a closed recording, and prints its summary.
  void finish();
  /// Whether any run latched a fault.
  [[nodiscard]] bool fault() const noexcept { return fault_; }
  /// Whether any run could not be played or recorded.
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
  [[nodiscard]] const scene::Scene& scene() const;
  Answer describe() const;
  Answer surface(bool at_rest);
  Answer tool(std::uint32_t hand) const;
  Answer picture();
  /// @throws LiveError before the first tick
  const haptics::Snapshot& newest_snapshot(const std::string& command);
  Answer load(const net::Load& wanted, const net::ClientRef& client);
  Answer start(const net::Start& wanted, const net::ClientRef& client);
  Answer stop(const net::ClientRef& client);
  Answer devices();
  Answer record(bool on);
  Answer steer(const net::SteerMouse& input);
  Answer steer(const net::SteerGamepad& input);
  Answer set_tissue(const net::TissueEdit& edit);
  Answer set_noise(const net::NoiseEdit& edit);
  Answer set_inclusion(const net::InclusionEdit& edit);
  [[nodiscard]] NextSession::Check check_of(bool is_clients) const;
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
  [[nodiscard]] std::optional<std::string> device_flag(const std::string& wanted) const;
  [[nodiscard]] nlohmann::ordered_json about_recording() const;
  void end_recording();
  void poll_recording();
  void move_hands();
  void measure_rate();
  void send_event(const std::string& event, nlohmann::ordered_json members);

  ServedOptions options_;
  std::unique_ptr<Session> first_;  // until the first run; has no devices once another scene is prepared
  std::optional<std::string> own_device_flag_;    // --device
  std::vector<scene::DeviceSetup> own_devices_;   // those with which the server was started
  std::unique_ptr<LiveRun<ServedObserver>> run_;  // the newest run, also after its end
  bool accounted_ = false;                        // the newest run has ended and its summary is printed
  std::unique_ptr<RunTape> tape_;  // of the newest run, for a page; null: whole runs are recorded
  std::string recording_failure_;  // why the newest recording is incomplete
  /// A gamepad of a page, and what the page sent last.
  struct PagePad {
    GamepadHand hand;
    GamepadState state{};
    std::int64_t heard_ns = 0;  // 0: nothing yet
  };
  std::vector<MouseHand> mice_;  // of the current run, for a page
  std::vector<PagePad> pads_;
  std::int64_t moved_hands_ns_ = 0;
  std::optional<double> rate_Hz_;            // of the newest run's ticks
  std::uint64_t rate_tick_ = 0;              // from which it is measured now
  std::int64_t rate_ns_ = 0;                 // beginning of that tick; 0: none yet
  std::optional<net::LiveSurface> surface_;  // organ of the newest run, made when a client first asks for it
  std::int64_t moved_ns_ = 0;                // monotonic time [ns] from which moved_ may be computed again
  nlohmann::ordered_json moved_;             // the displaced points of surface_
  bool request_is_clients_ = false;          // a client, not the command line, chose options_.request
  std::unique_ptr<NextSession> next_;
  bool next_is_clients_ = false;
  std::optional<net::ClientRef> next_client_;
  std::optional<scene::Overrides> load_next_;  // loaded after the cancelled next_ has ended, for next_client_
  std::vector<net::ClientRef> stop_clients_;
  LiveParameters now_;  // of the current run, or of the next one
  std::vector<net::Event> events_;
  const std::atomic<bool>* stop_ = nullptr;
  std::uint64_t runs_ = 0;
  bool had_clients_ = false;
  bool fault_ = false;
  bool failed_ = false;
};

}  // namespace palpate::app
