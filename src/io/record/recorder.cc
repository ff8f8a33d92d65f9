#include "io/record/recorder.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/spsc_queue.h"
#include "core/base/text.h"
#include "io/record/machine.h"
#include "io/record/recording_writer.h"
#include "io/system/clock.h"
#include "io/system/files.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

// In real time the ring must bridge a stalled disk. Offline the ticks wait for the disk, and less than a
// second of simulation may be lost when the process is killed.
constexpr double kRingSeconds = 8.0;
constexpr double kRingSecondsOffline = 0.25;
constexpr double kSimulatedFlush = 0.5;                  // s of simulated time
constexpr std::size_t kChangesKept = 1024;               // that wait for the writer
constexpr std::size_t kRingLeast = 64;                   // rows
constexpr std::size_t kRingMost = std::size_t{1} << 20;  // rows
constexpr std::chrono::milliseconds kPoll{10};
constexpr std::chrono::microseconds kPollOffline{500};
constexpr std::int64_t kFlushEvery = 200'000'000;   // ns
constexpr std::int64_t kToDiskEvery = 400'000'000;  // ns; such a flush waits for the disk

/// Rows of `seconds` of a simulation, within the bounds of the ring.
std::size_t ring_rows_in(double seconds, const scene::Scene& scene) {
  const double rows = scene.rate_Hz * static_cast<double>(scene.tools.size()) * seconds;
  if (!(rows < static_cast<double>(kRingMost))) return kRingMost;
  return std::max(kRingLeast, static_cast<std::size_t>(rows));
}

RunFacts facts_before(bool offline, const StudyMark& study) {
  RunFacts facts;
  facts.study = study;
  facts.version = palpate_version();
  facts.compiler = compiler_version();
  facts.machine = machine_description();
  facts.offline = offline;
  return facts;
}

TimeStatistics figures(const haptics::Histogram& histogram) {
  return {histogram.percentile(0.5), histogram.percentile(0.99), histogram.percentile(0.999),
          histogram.max()};
}

RunFacts facts_after(const haptics::LoopReport& report, bool complete) {
  RunFacts facts;
  facts.complete = complete;
  facts.missed_deadlines = report.missed_deadlines;
  facts.longest_gap_ns = report.longest_gap_ns;
  facts.realtime_priority = report.realtime_priority;
  facts.memory_locked = report.memory_locked;
  facts.polled = report.polled;
  facts.tick_time = figures(report.tick_time);
  facts.lateness = figures(report.lateness);
  facts.tick_histogram = report.tick_time.buckets();
  facts.late_histogram = report.lateness.buckets();
  facts.watchdog_stops = report.watchdog_stops;
  facts.remarks = report.remarks;
  return facts;
}

/// Creates the file that is written until the first tick is due, in the recording's folder.
std::filesystem::path make_partial(const std::filesystem::path& file) {
  std::string name = to_text(file.parent_path() / to_path("." + to_text(file.filename()) + ".partial."));
  const int descriptor = open_temporary_file(name, 0666);
  if (descriptor < 0) {
    throw InputError(to_text(file) + ": the recording cannot be made: " + std::strerror(errno));
  }
  ::close(descriptor);
  return to_path(name);
}

/// The recording's path, with symbolic links followed.
std::filesystem::path checked_target(const std::filesystem::path& file) {
  require_regular_output(file);
  return link_target(file);
}

}  // namespace

/// The writing thread, its ring and its flags.
struct Recorder::Impl {
  std::filesystem::path file;
  std::filesystem::path partial;
  bool offline = false;
  bool waits = false;      // the caller waits for room in the rings
  double rows_per_second;  // of simulated time
  std::function<void(const std::string&)> on_failure;
  SpscQueue<haptics::TickRow> ring;
  SpscQueue<haptics::ParameterUpdate> change_ring{kChangesKept};
  std::unique_ptr<RecordingWriter> writer;  // used by the thread; after its end by finish()

  std::atomic<std::int64_t> started_unix_ns{0};
  std::atomic<bool> begun{false};
  std::atomic<bool> finishing{false};
  std::atomic<std::uint64_t> rows_lost{0};

  // Used only by the thread:
  bool started = false;
  std::string failure;  // where the recording ends and why; empty: no failure
  std::uint64_t rows_written = 0;
  std::uint64_t rows_safe = 0;  // flushed rows, which survive the end of this process
  std::vector<haptics::TickRow> block;
  std::vector<haptics::ParameterUpdate> changes;
  std::int64_t next_flush = 0;
  std::int64_t next_to_disk = 0;
  std::size_t flush_rows;     // this number of rows is flushed at once
  std::size_t unflushed = 0;  // rows
  std::thread thread;

  Impl(std::filesystem::path target, const scene::Scene& scene, bool is_offline, bool does_wait,
       std::function<void(const std::string&)> when_it_fails)
      : file(std::move(target)),
        partial(make_partial(file)),
        offline(is_offline),
        waits(is_offline || does_wait),
        rows_per_second(scene.rate_Hz * static_cast<double>(scene.tools.size())),
        on_failure(std::move(when_it_fails)),
        ring(ring_rows_in(is_offline ? kRingSecondsOffline : kRingSeconds, scene)),
        flush_rows(ring_rows_in(kSimulatedFlush, scene)) {
    block.reserve(RecordingWriter::kChunkRows);
  }

  void run();
  void start();
  bool drain();
  void write_block();
  void flush(bool to_disk);
  void flush_when_due(bool now);
  void stop_thread();
  void close_file(const RunFacts& facts);
  void remove_partial() const noexcept;
  /// Runs a writing step; a failure ends all writing and is reported immediately.
  template <typename Step>
  void guarded(const Step& step);
  void fail(const std::string& why);
};

template <typename Step>
void Recorder::Impl::guarded(const Step& step) {
  if (!failure.empty()) return;
  try {
    step();
  } catch (const std::exception& error) {
    fail(error.what());
    if (on_failure) on_failure(failure);
  }
}

void Recorder::Impl::fail(const std::string& why) {
  try {
    if (!writer->damaged()) flush(false);  // space is reserved for what HDF5 still buffers
  } catch (const std::exception&) {        // then rows_safe stays smaller
  }
  failure = fmt::format("{}: the recording ends after its first {} rows ({} s): {}", to_text(file), rows_safe,
                        shortest(static_cast<double>(rows_safe) / rows_per_second), why);
}

void Recorder::Impl::run() {
  const hdf5::SilenceErrors quiet;
  for (bool last = false; !last;) {
    last = finishing.load(std::memory_order_acquire);
    if (!started && begun.load(std::memory_order_acquire)) start();
    const bool busy = drain();
    if (started) flush_when_due(last);
    if (last || busy) continue;
    if (offline) {
      std::this_thread::sleep_for(kPollOffline);
    } else {
      std::this_thread::sleep_for(kPoll);
    }
  }
}

/// The first tick is due: renames the file.
void Recorder::Impl::start() {
  started = true;
  next_flush = monotonic_ns() + kFlushEvery;
  guarded([this] {
    writer->start(started_unix_ns.load(std::memory_order_relaxed));
    writer->flush(true);
    if (is_special_file(file)) throw hdf5::Error("cannot be made: is no regular file any more");
    std::error_code error;
    std::filesystem::rename(partial, file, error);
    if (error) throw hdf5::Error("cannot be made: " + error.message());
    writer->moved_to(file);
    flush_folder(file.parent_path());
  });
}

/// Takes all rows of the ring. @return whether a block was written
bool Recorder::Impl::drain() {
  bool busy = false;
  haptics::TickRow row;
  while (started && ring.pop(row)) {
    block.push_back(row);
    ++unflushed;
    if (block.size() < RecordingWriter::kChunkRows && unflushed < flush_rows) continue;
    busy = true;
    write_block();
    flush_when_due(false);
  }
  return busy;
}

/// Updates come first, so that a truncated file has the updates of all its ticks.
void Recorder::Impl::write_block() {
  haptics::ParameterUpdate change;
  while (change_ring.pop(change)) changes.push_back(change);
  guarded([this] {
    writer->append(changes);
    writer->append(block);
    rows_written += block.size();
  });
  changes.clear();
  block.clear();
}

void Recorder::Impl::flush(bool to_disk) {
  writer->flush(to_disk);
  rows_safe = rows_written;
}

void Recorder::Impl::flush_when_due(bool now) {
  const std::int64_t time = monotonic_ns();
  if (!now && time < next_flush && unflushed < flush_rows) return;
  next_flush = time + kFlushEvery;
  if (!block.empty()) write_block();
  if (unflushed == 0) return;
  unflushed = 0;
  const bool to_disk = time >= next_to_disk;
  if (to_disk) next_to_disk = time + kToDiskEvery;
  guarded([this, to_disk] { flush(to_disk); });
}

void Recorder::Impl::stop_thread() {
  if (!thread.joinable()) return;
  finishing.store(true, std::memory_order_release);
  thread.join();
}

void Recorder::Impl::remove_partial() const noexcept {
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
}

/// Call after the thread has ended.
void Recorder::Impl::close_file(const RunFacts& facts) {
  if (!writer) return;
  const hdf5::SilenceErrors quiet;
  if (writer->damaged()) writer->abandon();
  if (writer->path() == partial) {
    remove_partial();  // the run never began, or the rename failed
  } else if (!writer->damaged()) {
    try {
      writer->write_summary(facts, rows_lost.load(std::memory_order_relaxed));
      writer->close();
    } catch (const std::exception& error) {
      if (failure.empty()) fail(error.what());
    }
  }
  writer.reset();
}

Recorder::Recorder(std::filesystem::path file, const scene::Scene& scene, bool offline,
                   std::function<void(const std::string&)> on_failure, const StudyMark& study, bool waits)
    : impl_(std::make_unique<Impl>(checked_target(file), scene, offline, waits, std::move(on_failure))) {
  const hdf5::SilenceErrors quiet;
  try {
    impl_->writer = std::make_unique<RecordingWriter>(impl_->partial, scene, facts_before(offline, study));
    impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
  } catch (const std::exception& error) {
    impl_->writer.reset();
    impl_->remove_partial();
    throw InputError(to_text(impl_->file) + ": the recording cannot be made: " + error.what());
  }
}

Recorder::~Recorder() {
  impl_->stop_thread();
  impl_->close_file(RunFacts{});
}

void Recorder::on_start(std::int64_t started_unix_ns) noexcept {
  impl_->started_unix_ns.store(started_unix_ns, std::memory_order_relaxed);
  impl_->begun.store(true, std::memory_order_release);
}

void Recorder::on_update(const haptics::ParameterUpdate& change) noexcept {
  while (!impl_->change_ring.push(change)) {
    if (!impl_->waits) {
      impl_->rows_lost.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    std::this_thread::sleep_for(kPollOffline / 5);
  }
}

void Recorder::on_row(const haptics::TickRow& row) noexcept {
  while (!impl_->ring.push(row)) {
    if (!impl_->waits) {
      impl_->rows_lost.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    std::this_thread::sleep_for(kPollOffline / 5);
  }
}

void Recorder::finish(const haptics::LoopReport& report) {
  impl_->stop_thread();
  const std::uint64_t lost = impl_->rows_lost.load(std::memory_order_relaxed);
  impl_->close_file(facts_after(report, impl_->failure.empty()));
  if (!impl_->failure.empty()) throw InputError(impl_->failure);
  if (lost > 0) {
    throw InputError(to_text(impl_->file) + ": the disk could not keep up, " + std::to_string(lost) +
                     " rows are missing from the recording");
  }
}

}  // namespace palpate::record
