#include "io/record/csv_recorder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/base/text.h"
#include "io/record/csv_rows.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

constexpr std::size_t kCsvRowsWaiting = 256;  // rows that the ticking thread writes at a time
constexpr double kCsvRingSeconds = 8.0;       // a stalled disk that the ring bridges
constexpr double kMaxCsvRing = 1 << 18;       // rows
constexpr std::size_t kMaxUpdates = 1024;
constexpr std::chrono::milliseconds kCsvPoll{10};

std::size_t csv_ring_rows(const scene::Scene& scene, bool waits) {
  const double rows = scene.rate_Hz * static_cast<double>(scene.tools.size()) * kCsvRingSeconds;
  return waits ? kCsvRowsWaiting : static_cast<std::size_t>(std::clamp(rows, 1024.0, kMaxCsvRing));
}

}  // namespace

CsvRecorder::CsvRecorder(std::filesystem::path file, const scene::Scene& scene, bool waits)
    : file_(std::move(file)),
      waits_(waits),
      ring_(csv_ring_rows(scene, waits)),
      updates_(kMaxUpdates),
      text_(longest_csv_row()) {
  require_regular_output(file_);
  out_.open(file_, std::ios::binary);
  out_ << csv_header();
  if (!out_) {
    throw InputError(to_text(file_) + ": the recording cannot be made: " + std::strerror(errno));
  }
  if (waits_) return;
  try {
    thread_ = std::thread([this] {
      for (bool last = false; !last;) {
        last = finishing_.load(std::memory_order_acquire);
        drain();
        if (!last) std::this_thread::sleep_for(kCsvPoll);
      }
    });
  } catch (const std::system_error&) {
    throw InputError(to_text(file_) + ": this system has no threads, a recording needs record_waits = 1");
  }
}

CsvRecorder::~CsvRecorder() { stop_thread(); }

void CsvRecorder::stop_thread() {
  if (!thread_.joinable()) return;
  finishing_.store(true, std::memory_order_release);
  thread_.join();
}

void CsvRecorder::drain() noexcept {
  for (haptics::TickRow row; ring_.pop(row);) {
    if (failure_ != 0) continue;
    out_.write(text_.data(), append_csv_row(text_.data(), row) - text_.data());
    if (!out_) failure_ = errno == 0 ? EIO : errno;
  }
}

void CsvRecorder::on_update(const haptics::ParameterUpdate& update) noexcept {
  if (!updates_.push(update)) rows_lost_.fetch_add(1, std::memory_order_relaxed);
}

void CsvRecorder::on_row(const haptics::TickRow& row) noexcept {
  while (!ring_.push(row)) {
    if (!waits_) {
      rows_lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    drain();
  }
}

void CsvRecorder::flush() {
  if (!waits_) return;  // its thread writes
  drain();
  out_.flush();
}

void CsvRecorder::finish(const haptics::LoopReport& /*report*/) {
  stop_thread();
  drain();
  if (failure_ == 0) {
    out_.close();
    if (!out_) failure_ = errno == 0 ? EIO : errno;
  }
  if (failure_ != 0) {
    throw InputError(to_text(file_) + ": the recording is cut off: " + std::strerror(failure_));
  }
  std::vector<haptics::ParameterUpdate> updates;
  for (haptics::ParameterUpdate update; updates_.pop(update);) updates.push_back(update);
  if (!updates.empty()) write_output(changes_csv_path(file_), changes_csv(updates));
  if (const std::uint64_t lost = rows_lost_.load(std::memory_order_relaxed); lost > 0) {
    throw InputError(to_text(file_) + ": the disk could not keep up, " + counted(lost, "row", "rows") +
                     " are missing from the recording");
  }
}

}  // namespace palpate::record
