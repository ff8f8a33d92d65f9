#include "app/run_tape.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "io/system/file_exists.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlockRows = 1024;  // half a megabyte

}  // namespace

RunTape::RunTape(const scene::Scene& scene, std::uint64_t max_bytes)
    : scene_(scene), max_rows_(max_bytes / sizeof(haptics::TickRow)) {
  block_.reserve(kBlockRows);
  if (!folder_.path().empty()) {
    (void)disk_.open(folder_.path() / "rows",
                     std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  }
  if (!disk_.is_open()) gap_ = "no temporary file can be made in " + to_text(fs::temp_directory_path());
  // The open file needs no name, so that nothing remains when the program is killed. Windows keeps the name.
  std::error_code ignored;
  fs::remove_all(folder_.path(), ignored);
}

void RunTape::add(const haptics::TickRow& row) {
  const std::uint64_t hands = scene_.tools.size();
  if (row.hand == 0) {
    const auto period = static_cast<std::int64_t>(std::lround(1e9 / scene_.rate_Hz));
    tick_time_.add(row.tick_ns);
    lateness_.add(row.late_ns);
    if (row.late_ns >= period) ++missed_;
    // A tick that begins a full period late moves the schedule.
    const std::int64_t before = late_before_ns_ < period ? late_before_ns_ : 0;
    if (row.tick > 0) longest_gap_ns_ = std::max(longest_gap_ns_, period + row.late_ns - before);
    late_before_ns_ = row.late_ns;
  }
  if (!gap_.empty()) return;
  if (row.tick * hands + row.hand != rows()) {
    gap_ = fmt::format("this computer was too busy: rows after {:.1f} s are missing",
                       static_cast<double>(rows() / hands) / scene_.rate_Hz);
    return;
  }
  if (rows() >= max_rows_) {
    gap_ = fmt::format("only the first {:.0f} minutes of a run are kept",
                       static_cast<double>(rows() / hands) / scene_.rate_Hz / 60.0);
    return;
  }
  block_.push_back(row);
  if (block_.size() == kBlockRows) write_block();
}

void RunTape::write_block() {
  const auto bytes = static_cast<std::streamsize>(block_.size() * sizeof(haptics::TickRow));
  (void)disk_.pubseekpos(static_cast<std::streamoff>(on_disk_ * sizeof(haptics::TickRow)));
  if (disk_.sputn(reinterpret_cast<const char*>(block_.data()), bytes) != bytes || disk_.pubsync() != 0) {
    gap_ = "the temporary file of the run cannot be written: is the disk full?";
    return;
  }
  on_disk_ += block_.size();
  block_.clear();
}

/// Fills `rows` with kept rows from number `from` on.
void RunTape::read_rows(std::uint64_t from, std::vector<haptics::TickRow>& rows) {
  const std::uint64_t in_file = from < on_disk_ ? std::min<std::uint64_t>(rows.size(), on_disk_ - from) : 0;
  const auto bytes = static_cast<std::streamsize>(in_file * sizeof(haptics::TickRow));
  (void)disk_.pubseekpos(static_cast<std::streamoff>(from * sizeof(haptics::TickRow)));
  if (disk_.sgetn(reinterpret_cast<char*>(rows.data()), bytes) != bytes)
    throw InputError(to_text(file_) + ": the temporary file of the run cannot be read");
  const std::uint64_t first = from + in_file - on_disk_;
  std::copy_n(block_.begin() + static_cast<std::ptrdiff_t>(first), rows.size() - in_file,
              rows.begin() + static_cast<std::ptrdiff_t>(in_file));
}

void RunTape::begin(const fs::path& file, std::int64_t started_unix_ns) {
  if (!gap_.empty()) throw InputError(gap_ + ": a recording needs all of them. Run again and record that");
  auto on_failure = [this](const std::string& why) {
    const std::lock_guard lock(mutex_);
    writing_failure_ = why;
  };
  {
    const std::lock_guard lock(mutex_);
    writing_failure_.clear();
  }
  recorder_ = std::make_unique<record::Recorder>(file, scene_, false, std::move(on_failure),
                                                 record::StudyMark{}, true);
  recorder_->on_start(started_unix_ns);
  file_ = file;
  fed_ = 0;
  updates_fed_ = 0;
}

bool RunTape::feed(std::size_t max_rows) {
  if (recorder_ == nullptr) return true;
  const std::uint64_t hands = scene_.tools.size();
  const std::uint64_t whole = rows() - rows() % hands;  // complete ticks
  std::vector<haptics::TickRow> some;
  for (std::size_t left = max_rows; left > 0 && fed_ < whole; left -= std::min(left, some.size())) {
    some.resize(std::min<std::uint64_t>({left, whole - fed_, kBlockRows}));
    read_rows(fed_, some);
    for (const haptics::TickRow& row : some) {
      while (updates_fed_ < updates_.size() && updates_[updates_fed_].tick <= row.tick) {
        recorder_->on_update(updates_[updates_fed_++]);
      }
      recorder_->on_row(row);
    }
    fed_ += some.size();
  }
  return fed_ == whole;
}

haptics::LoopReport RunTape::report_so_far() const {
  haptics::LoopReport report;
  report.tick_time = tick_time_;
  report.lateness = lateness_;
  report.missed_deadlines = missed_;
  report.longest_gap_ns = longest_gap_ns_;
  report.remarks = {
      "the recording ended before its run: it does not tell whether the loop had real-time priority"};
  return report;
}

void RunTape::end(const haptics::LoopReport* report) {
  if (recorder_ == nullptr) return;
  while (!feed()) {
  }
  const std::unique_ptr<record::Recorder> recorder = std::move(recorder_);
  recorder->finish(report != nullptr ? *report : report_so_far());
  if (!gap_.empty()) throw InputError(to_text(file_) + ": the recording ends before its run: " + gap_);
}

std::string RunTape::failure() const {
  const std::lock_guard lock(mutex_);
  if (!writing_failure_.empty()) return writing_failure_;
  return recorder_ != nullptr ? gap_ : std::string();
}

fs::path free_name(const fs::path& file, bool allow_itself) {
  if (allow_itself && !file_exists(file)) return file;
  for (int number = 2;; ++number) {
    fs::path name = file;
    name.replace_filename(
        to_path(to_text(file.stem()) + "-" + std::to_string(number) + to_text(file.extension())));
    if (!file_exists(name)) return name;
  }
}

fs::path named_by_time(const std::string& ending) {
  return fs::current_path() /
         fmt::format("palpate-{:%Y%m%d-%H%M%S}{}", fmt::localtime(std::time(nullptr)), ending);
}

}  // namespace palpate::app
