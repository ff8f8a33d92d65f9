#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "core/base/spsc_queue.h"
#include "io/system/own_process.h"
#include "palpate/session.h"
#include "palpate/triple_buffer.h"

#include "bindings/python/surface.h"

namespace palpate::python {

/// Collects the rows of a running loop for Python: the latest rows at once, all rows a moment later. The loop
/// never waits. When the collecting thread is too slow, rows are dropped and counted.
class RowCollector final : public haptics::TickObserver {
 public:
  using Newest = std::array<haptics::TickRow, kMaxHands>;  // one per hand

  /// [setup] @param kept maximum number of rows; the oldest rows are dropped
  RowCollector(std::size_t hands, std::size_t kept);
  ~RowCollector() override;
  RowCollector(const RowCollector&) = delete;
  RowCollector& operator=(const RowCollector&) = delete;

  void on_row(const haptics::TickRow& row) noexcept override;

  /// [any] Stops the collecting thread after the run. rows() then collects the remaining rows.
  void rest() noexcept { thread_.request_stop(); }
  /// [any] The rows of the newest tick; nothing before the first.
  [[nodiscard]] std::optional<Newest> newest();
  /// [any] The kept rows, ordered by tick, then hand.
  [[nodiscard]] std::vector<haptics::TickRow> rows();
  /// [any] Number of rows that were dropped because they were too old or the queue was full.
  [[nodiscard]] std::uint64_t rows_missing();

 private:
  static constexpr std::size_t kRoom = 1U << 15U;  // rows: 32 s of one hand at 1 kHz

  void collect(const std::stop_token& stop);
  void drain();

  std::size_t hands_;
  std::size_t kept_;
  TripleBuffer<Newest> newest_;
  bool any_ = false;  // a tick was received
  SpscQueue<haptics::TickRow> ring_{kRoom};
  std::atomic<std::uint64_t> left_out_{0};
  std::mutex readers_;  // one reader at a time; the loop never locks it
  std::deque<haptics::TickRow> rows_;
  std::uint64_t dropped_ = 0;
  std::jthread thread_;  // last member, because it uses the others
};

/// Simulation in real time on separate threads, like `palpate run` without a window. Python reads its state
/// and changes tissue and noise during the run. start() starts it and stop() ends it (zero force, recording
/// closed). The end of a `with` block, of this object or of the program also stops it. Every device that
/// needs no window can be used. An object runs once. A fault sets its hand's force to zero until
/// reset_fault().
class LiveSimulation final {
 public:
  struct Options {
    std::optional<double> duration_s;             // none: until the last tick of the devices' paths
    std::optional<std::filesystem::path> record;  // HDF5 file
    haptics::LoopThread thread;                   // thread settings of the loop
    double keep_s = 600.0;                        // s, time span of the rows that rows() keeps
    double surface_edge = 0.0;                    // m, edge length of surface(), as for visible_surface()
    bool cache = true;
  };

  /// [setup] Opens the devices and prepares the organ. @throws InputError, ParameterError
  LiveSimulation(scene::Scene scene, Options options);
  /// Stops the run.
  ~LiveSimulation();
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  /// [any] Starts the run and returns after its first tick. Raises RuntimeError if it was started before,
  /// InputError if the recording cannot be created.
  void start();
  /// [any] False in a child process made by fork(), where the run has no threads and its devices and its
  /// recording are the parent's. There stop() does nothing, the object must not be destroyed, and other calls
  /// raise RuntimeError.
  [[nodiscard]] bool is_own() const noexcept { return process_.is_current(); }
  /// [any] Stops the run and waits until it has ended: zero force, recording closed. Does nothing before
  /// start() or after the end.
  void stop();
  /// [any] Waits at most `time` for the end of the run. @return whether it has ended; false before start()
  [[nodiscard]] bool ended_within(std::chrono::milliseconds time);
  /// [any] Whether the run has started and not ended.
  [[nodiscard]] bool running();

  /// [any] The rows of the newest tick, one per hand; empty before the first.
  [[nodiscard]] std::vector<haptics::TickRow> newest();
  /// [any] The fault of a row as text, with the device's own message; empty without a fault.
  [[nodiscard]] std::string describe_fault(const haptics::TickRow& row) const;
  /// [any] Number of the last parameter update that a tick has used; 0: none.
  [[nodiscard]] std::uint64_t change();
  /// [any] The organ's visible surface at the newest tick. The first call takes longer.
  [[nodiscard]] Surface surface();
  /// [any] The rows of the last keep_s seconds. During a run the latest rows may be missing.
  [[nodiscard]] std::vector<haptics::TickRow> rows();
  /// [any] Number of rows that rows() does not have.
  [[nodiscard]] std::uint64_t rows_missing();

  /// [any] Clears the latched faults of the hands in `hand_bits` at the next tick. The force of a held device
  /// starts again by a ramp, after the hand was still outside the tissue.
  void reset_faults(std::uint32_t hand_bits) {
    require_own();
    session_.control().reset_faults(hand_bits);
  }
  /// [any] Sends new tissue and noise parameters to the loop.
  [[nodiscard]] haptics::ParameterUpdates& changes() {
    require_own();
    return session_.updates();
  }

  [[nodiscard]] const scene::Scene& scene() const noexcept { return session_.scene(); }
  [[nodiscard]] std::size_t hands() const noexcept { return session_.hands(); }
  /// [any] Result of the ended run; default values if it failed. @throws std::logic_error before the end
  [[nodiscard]] session::RunResult result();
  /// [any] After the end, once: why the run failed or its recording is incomplete. Otherwise empty.
  [[nodiscard]] std::string take_failure();

 private:
  [[nodiscard]] session::BackgroundRun* run();
  void require_own() const;

  OwnProcess process_;
  Options options_;
  session::Session session_;
  RowCollector rows_;
  haptics::SnapshotPublisher snapshots_;

  std::mutex looking_;  // guards the reader of snapshots_ and the members below
  std::unique_ptr<deform::SurfaceDeformer> deformer_;

  std::mutex state_;  // guards the members below
  bool failure_reported_ = false;
  std::unique_ptr<session::BackgroundRun> run_;  // set by start(); last member, because it uses the others
};

}  // namespace palpate::python
