#include "io/record/flight_recorder.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>

#include "io/record/recorder.h"
#include "io/system/cache_folder.h"
#include "io/system/clock.h"
#include "io/system/files.h"

namespace palpate::record {
namespace {

std::size_t rows_in(double seconds, const scene::Scene& scene) {
  return static_cast<std::size_t>(std::ceil(seconds * scene.rate_Hz)) * scene.tools.size();
}

}  // namespace

FlightRecorder::FlightRecorder(const scene::Scene& scene, StudyMark study)
    : scene_(scene),
      study_(std::move(study)),
      hands_(scene.tools.size()),
      rows_after_fault_(rows_in(kAfter, scene)),
      ring_(rows_in(kKept, scene) + rows_in(kAfter, scene)) {}

void FlightRecorder::on_start(std::int64_t started_unix_ns) noexcept { started_unix_ns_ = started_unix_ns; }

void FlightRecorder::on_update(const haptics::ParameterUpdate& change) noexcept {
  if (fault_met_ && rows_after_fault_ == 0) return;
  changes_[changes_seen_ % kChangesKept] = change;
  ++changes_seen_;
}

void FlightRecorder::on_row(const haptics::TickRow& row) noexcept {
  if (row.fault != 0) fault_met_ = true;
  if (fault_met_) {
    if (rows_after_fault_ == 0) return;
    --rows_after_fault_;
  }
  ring_[seen_ % ring_.size()] = row;
  ++seen_;
}

std::vector<haptics::TickRow> FlightRecorder::rows() const {
  const std::uint64_t kept = std::min<std::uint64_t>(seen_, ring_.size());
  std::vector<haptics::TickRow> rows;
  rows.reserve(kept);
  for (std::uint64_t i = seen_ - kept; i < seen_; ++i) rows.push_back(ring_[i % ring_.size()]);
  // A fault of the second hand can end the last tick early; the ring can overwrite a part of the first tick.
  while (!rows.empty() && rows.front().hand != 0) rows.erase(rows.begin());
  while (!rows.empty() && rows.back().hand + 1 != hands_) rows.pop_back();
  return rows;
}

std::vector<haptics::ParameterUpdate> FlightRecorder::changes() const {
  std::vector<haptics::ParameterUpdate> changes;
  const std::uint64_t kept = std::min<std::uint64_t>(changes_seen_, kChangesKept);
  for (std::uint64_t i = changes_seen_ - kept; i < changes_seen_; ++i) {
    changes.push_back(changes_[i % kChangesKept]);
  }
  return changes;
}

void FlightRecorder::write(const std::filesystem::path& file, const haptics::LoopReport& report) const {
  Recorder recorder(file, scene_, true, {}, study_);
  recorder.on_start(started_unix_ns_);
  for (const haptics::ParameterUpdate& change : changes()) recorder.on_update(change);
  for (const haptics::TickRow& row : rows()) recorder.on_row(row);
  recorder.finish(report);
}

std::filesystem::path write_flight_recording(const FlightRecorder& flight,
                                             const haptics::LoopReport& report) {
  constexpr std::uint64_t kMaxBytes = 256UL << 20U;  // of all such files; the oldest are removed first
  const std::filesystem::path folder = user_state_folder() / "faults";
  if (!folder.is_absolute()) return {};
  const std::int64_t now_ms = unix_ns() / 1'000'000;
  std::filesystem::path file = folder / (std::to_string(now_ms) + "-" + std::to_string(process_id()) + ".h5");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  trim_cache(folder, ".h5", kMaxBytes);
  flight.write(file, report);
  return file;
}

}  // namespace palpate::record
