#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace palpate::study {

/// What a marker says, as the byte that a serial port gets. Nothing in it depends on the condition. No code
/// follows itself, so that a box that holds the level of the last byte shows each of them.
enum class MarkerCode : std::uint8_t {
  kFirstInterval = 1,   // the first interval begins to count
  kSecondInterval = 2,  // the second one
  kFirstAnswer = 3,     // the participant chose the first interval
  kSecondAnswer = 4,
  kNoAnswer = 5  // the trial ended without an answer, after an interval
};

/// A marker and the trial that it belongs to.
struct Marker {
  MarkerCode code = MarkerCode::kFirstInterval;
  std::uint64_t tick = 0;  // in the recording of the block
  int session = 1;
  int block = 1;
  std::string task;
  int number = 0;  // as TrialRecord::number
  bool practice = false;
};

/// Where markers go.
struct MarkerTarget {
  std::string text;     // as written: serial:PATH[@BAUD] or tcp:HOST:PORT
  bool serial = false;  // else TCP
  std::string name;     // path or host
  int number = 115200;  // baud or port
};

/// [setup] Parses "serial:/dev/ttyUSB0", "serial:/dev/ttyUSB0@9600" or "tcp:127.0.0.1:5678". @param who
/// begins the message @throws InputError
[[nodiscard]] MarkerTarget parse_marker_target(const std::string& text, const std::string& who);

/// Sends markers of a session to other instruments: a serial port gets one byte, a TCP server a line of JSON
/// with the tick and its wall time (unix_ns). Each marker leaves at the time of its tick, or at once when
/// that is over, from a thread of its own.
class Markers final {
 public:
  /// [setup] Opens all targets. @throws InputError naming the one that is missing or refused
  explicit Markers(const std::vector<MarkerTarget>& targets);
  /// Sends what waits, and closes the targets.
  ~Markers();
  Markers(const Markers&) = delete;
  Markers& operator=(const Markers&) = delete;

  /// [setup] A block begins. The ticks of the markers that follow are those of its run.
  void begin_block(double rate_Hz);
  /// [rt] A tick was due at a monotonic time [ns].
  void note_tick(std::uint64_t tick, std::int64_t due) noexcept;
  /// [any] Sends a marker when its tick is due.
  void send(Marker marker);

  /// What was sent since begin_block().
  struct Report {
    std::size_t sent = 0;         // to all targets
    std::size_t lost = 0;         // not to all
    std::int64_t worst_late = 0;  // ns, from the tick to the end of the last write
  };
  /// [setup] Waits until all markers are sent.
  [[nodiscard]] Report finish_block();
  /// [any] "serial:/dev/ttyUSB0: Input/output error" of the first target that failed; empty: none did.
  [[nodiscard]] std::string failure() const;

 private:
  struct Port;

  void run();
  [[nodiscard]] std::int64_t time_of(std::uint64_t tick) const noexcept;
  [[nodiscard]] bool write_all(const Marker& marker, std::int64_t due);

  std::vector<std::unique_ptr<Port>> ports_;
  std::atomic<double> period_ns_{1e6};
  std::atomic<std::int64_t> first_tick_{0};  // monotonic time at which tick 0 would have been due [ns]
  mutable std::mutex mutex_;                 // guards all below
  std::condition_variable changed_;
  std::deque<Marker> waiting_;
  Report report_;
  std::string failure_;
  bool ending_ = false;
  std::thread thread_;  // last member: the thread uses all members above
};

}  // namespace palpate::study
