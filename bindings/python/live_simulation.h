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
#include "palpate/session.h"
#include "palpate/triple_buffer.h"

#include "bindings/python/surface.h"

namespace palpate::python {

/// Lets Python see the rows of a running loop: the newest at once, all of them a moment later. The loop never
/// waits: when the collecting thread does not keep up, rows are left out and counted.
class RowCollector final : public haptics::TickObserver {
 public:
  using Newest = std::array<haptics::TickRow, haptics::Snapshot::kMaxHands>;  // one a hand

  /// [setup] @param kept rows at most; older ones are dropped
  RowCollector(std::size_t hands, std::size_t kept);
  ~RowCollector() override;
  RowCollector(const RowCollector&) = delete;
  RowCollector& operator=(const RowCollector&) = delete;

  void on_row(const haptics::TickRow& row) noexcept override;

  /// [any] The run has ended: nothing more has to be collected before it is asked for.
  void rest() noexcept { thread_.request_stop(); }
  /// [any] The rows of the newest tick; nothing before the first.
  [[nodiscard]] std::optional<Newest> newest();
  /// [any] What is kept so far, by tick, then hand.
  [[nodiscard]] std::vector<haptics::TickRow> rows();
  /// [any] Rows that are not there: dropped as too old, or left out.
  [[nodiscard]] std::uint64_t rows_missing();

 private:
  static constexpr std::size_t kRoom = 1U << 15U;  // rows: 32 s of one hand at 1 kHz

  void collect(const std::stop_token& stop);
  void drain();

  std::size_t hands_;
  std::size_t kept_;
  TripleBuffer<Newest> newest_;
  bool any_ = false;  // a newest was seen
  SpscQueue<haptics::TickRow> ring_{kRoom};
  std::atomic<std::uint64_t> left_out_{0};
  std::mutex readers_;  // one at a time; the loop never takes it
  std::deque<haptics::TickRow> rows_;
  std::uint64_t dropped_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

/// A scene in real time on threads of its own, as `palpate run` runs it without a window, while Python looks
/// on and changes tissue and noise. start() begins it, stop() ends it in good order (zero force, recording
/// closed); so does the end of a `with` block, and the end of this object or of the program. Every device
/// that needs no window can be used. One run an object. A fault brings its hand's force to zero until
/// reset_fault().
class LiveSimulation final {
 public:
  struct Options {
    std::optional<double> duration_s;             // none: until the devices have nothing more to say
    std::optional<std::filesystem::path> record;  // HDF5 file to write
    haptics::LoopThread thread;                   // of the loop
    double keep_s = 600.0;                        // how much rows() keeps
    double surface_edge = 0.0;                    // m, of surface(): as visible_surface()
    bool cache = true;
  };

  /// [setup] Opens the devices and prepares the organ. @throws InputError, ParameterError.
  LiveSimulation(scene::Scene setup, Options options);
  /// Ends the run as stop() does.
  ~LiveSimulation();
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  /// [any] Begins the run and returns when its first tick is made. Raises RuntimeError when it was begun
  /// before, InputError when the recording cannot be made.
  void start();
  /// [any] Ends the run in good order and waits for it: zero force, recording closed. Nothing happens when it
  /// has ended or was never begun.
  void stop();
  /// [any] Whether the run has ended within `time`; false before start().
  [[nodiscard]] bool ended_within(std::chrono::milliseconds time);
  /// [any] Whether it was begun and has not ended.
  [[nodiscard]] bool running();

  /// [any] The rows of the newest tick, one a hand; empty before the first.
  [[nodiscard]] std::vector<haptics::TickRow> newest();
  /// [any] Its fault in words, with what the device says of it; empty: none.
  [[nodiscard]] std::string describe_fault(const haptics::TickRow& row) const;
  /// [any] Number of the last change of tissue or noise that a tick has used; 0: none.
  [[nodiscard]] std::uint64_t change();
  /// [any] The organ's visible surface at the newest tick. The first call takes longer.
  [[nodiscard]] Surface surface();
  /// [any] Rows kept so far: all of the last keep_s seconds, but for the last moments of a run under way.
  [[nodiscard]] std::vector<haptics::TickRow> rows();
  /// [any] Rows that rows() no longer has.
  [[nodiscard]] std::uint64_t rows_missing();

  /// [any] Clears the latched faults of the hands in `hand_bits` at the next tick. A held device gets force
  /// again after it has been still outside the tissue.
  void reset_faults(std::uint32_t hand_bits) noexcept { session_.control().reset_faults(hand_bits); }
  /// [any] Hands new tissue and noise to the loop.
  [[nodiscard]] haptics::ParameterUpdates& changes() noexcept { return session_.updates(); }

  [[nodiscard]] const scene::Scene& setup() const noexcept { return session_.setup(); }
  [[nodiscard]] std::size_t hands() const noexcept { return session_.hands(); }
  /// [any] After the end: how it went; a run that broke off has the default values. @throws std::logic_error
  /// before the end.
  [[nodiscard]] session::RunResult result();
  /// [any] After the end: why it broke off or its recording is not whole, once; then and otherwise empty.
  [[nodiscard]] std::string take_failure();

 private:
  [[nodiscard]] session::BackgroundRun* run();

  Options options_;
  session::Session session_;
  RowCollector rows_;
  haptics::SnapshotPublisher snapshots_;

  std::mutex looking_;  // of snapshots_' reader and of what follows
  std::unique_ptr<deform::SurfaceDeformer> deformer_;

  std::mutex state_;  // of what follows
  bool failure_reported_ = false;
  std::unique_ptr<session::BackgroundRun> run_;  // from start() on; last: it uses all of the above
};

}  // namespace palpate::python
