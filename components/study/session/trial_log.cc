#include "study/session/trial_log.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <limits>
#include <string_view>

#include <fcntl.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/text.h"
#include "io/system/clock.h"
#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/input_file.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr InputKind kLogInput{"a participant's log", std::uint64_t{256} << 20};
// Names that a line has by itself.
constexpr std::array<std::string_view, 6> kLineKeys{"n", "previous", "type", "time", "event", "mac"};
constexpr std::string_view kMacStart = ",\"mac\":\"";  // the end of a line: its mac
constexpr std::string_view kMacEnd = "\"}";
constexpr std::size_t kMacDigits = 64;
constexpr std::size_t kDateDigits = 10;  // of a time
constexpr const char* kDeletedEvent = "deleted";
constexpr const char* kDamagedLog = "damaged";

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// The fields of an interval and of a trial in the order of a line. `field` is called with key, member and,
// for a whole number, the largest of its type.
void visit_interval(auto& cues, auto&& field) {
  field("from_tick", cues.from_tick);
  field("to_tick", cues.to_tick);
  field("peak_force_N", cues.peak_force);
  field("mean_force_N", cues.mean_force);
  field("depth_m", cues.depth);
  field("work_J", cues.work);
}

void visit_trial(auto& trial, auto&& field) {
  constexpr std::uint16_t kMaxRuns = std::numeric_limits<std::uint16_t>::max();
  constexpr std::uint8_t kMaxAnswer = 2;
  field("time", trial.time);
  field("session", trial.session, kMaxRuns);
  field("block", trial.block, kMaxRuns);
  field("task", trial.task);
  field("repeat", trial.repeat);
  field("practice", trial.practice);
  field("catch", trial.catch_trial);
  field("number", trial.number, std::numeric_limits<int>::max());
  field("code", trial.code);
  field("level", trial.level);
  field("second", trial.second);
  field("answer", trial.answer, kMaxAnswer);
  field("counted", trial.counted);
  field("response_time_s", trial.response_time);
  field("spoiled", trial.spoiled);
  field("intervals", trial.intervals);
  field("rms_error_N", trial.rms_error);
  field("variation", trial.variation);
  field("observer", trial.observer);
}

struct FieldWriter {
  Json& json;

  void operator()(const char* key, double value) const {
    if (!std::isfinite(value)) throw ParameterError(key, value, "finite");
    json[key] = value;
  }
  void operator()(const char* key, const std::array<IntervalCues, 2>& intervals) const {
    Json& all = json[key] = Json::array();
    for (const IntervalCues& cues : intervals) visit_interval(cues, FieldWriter{all.emplace_back()});
  }
  void operator()(const char* key, const auto& value, auto... /*most*/) const { json[key] = value; }
};

struct FieldReader {
  const JsonField& json;

  void operator()(const char* key, std::string& value) const { value = json.at(key).text(); }
  void operator()(const char* key, bool& value) const { value = json.at(key).flag(); }
  void operator()(const char* key, double& value) const { value = json.at(key).number(); }
  void operator()(const char* key, std::vector<std::string>& value) const { value = json.at(key).texts(); }
  void operator()(const char* key, std::uint64_t& value) const {
    value = json.at(key).whole<std::uint64_t>();
  }
  template <std::integral Whole>
  void operator()(const char* key, int& value, Whole most) const {
    value = json.at(key).whole<Whole>(most);
  }
  void operator()(const char* key, std::array<IntervalCues, 2>& intervals) const {
    const std::vector<JsonField> read = json.at(key).exactly(intervals.size());
    for (std::size_t i = 0; i < read.size(); ++i) visit_interval(intervals[i], FieldReader{read[i]});
  }
};

Json json_of_trial(const TrialRecord& trial) {
  Json json;
  json["type"] = "trial";
  visit_trial(trial, FieldWriter{json});
  return json;
}

TrialRecord trial_of(const JsonField& json) {
  TrialRecord trial;
  visit_trial(trial, FieldReader{json});
  return trial;
}

Json json_of_event(const EventRecord& event) {
  Json json;
  json["type"] = "event";
  json["time"] = event.time;
  json["event"] = event.event;
  for (const auto& [name, value] : event.values) {
    const bool reserved = std::find(kLineKeys.begin(), kLineKeys.end(), name) != kLineKeys.end();
    if (reserved || json.contains(name)) {
      throw InputError(
          fmt::format("event {}: value {}: the name is taken, must be another", event.event, one_line(name)));
    }
    json[name] = value;
  }
  return json;
}

Deletion deletion_of(const EventRecord& event) {
  Deletion deletion{event.time, event.value("reason"), {}, event.value("log") == kDamagedLog};
  deletion.before.lines = std::strtoull(event.value("lines").c_str(), nullptr, 10);
  deletion.before.mac = event.value("last_mac");
  return deletion;
}

EventRecord event_of(const JsonField& json, std::string_view text) {
  EventRecord event;
  event.time = json.at("time").text();
  event.event = json.at("event").text();
  const Json ordered = parse_ordered_json(text);
  for (const auto& [name, value] : ordered.items()) {
    if (std::find(kLineKeys.begin(), kLineKeys.end(), name) != kLineKeys.end()) continue;
    event.values.emplace_back(name, json.at(name).text());
  }
  return event;
}

/// A line of a log and what the chain needs of it.
struct LogLine {
  std::string_view text;
  nlohmann::json json;

  /// The text that the mac is of, and the mac; both empty when the line does not end with a mac.
  [[nodiscard]] std::string_view signed_text() const {
    constexpr std::size_t kEnd = kMacStart.size() + kMacDigits + kMacEnd.size();
    if (text.size() < kEnd || !text.ends_with(kMacEnd)) return {};
    const std::string_view before = text.substr(0, text.size() - kEnd);
    return text.substr(before.size()).starts_with(kMacStart) ? before : std::string_view{};
  }
  [[nodiscard]] std::string_view mac() const {
    return signed_text().empty() ? std::string_view{}
                                 : text.substr(signed_text().size() + kMacStart.size(), kMacDigits);
  }
};

/// Lines of a log up to the last complete one.
struct LogLines {
  std::vector<LogLine> lines;
  std::size_t complete = 0;  // bytes
};

[[noreturn]] void fail_line(const fs::path& file, std::size_t line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", file.string(), line, what));
}

/// The JSON of a line; null for a text that is no JSON.
nlohmann::json json_of_line(std::string_view text) {
  try {
    return parse_json(text);
  } catch (const InputError&) {
    return nullptr;
  }
}

LogLines split_log(const fs::path& file, std::string_view bytes) {
  LogLines found;
  while (found.complete < bytes.size()) {
    const std::size_t end = bytes.find('\n', found.complete);
    if (end == std::string_view::npos) break;
    const std::string_view text = bytes.substr(found.complete, end - found.complete);
    nlohmann::json json = json_of_line(text);
    if (!json.is_object()) {
      // A file system may leave zeros for a part of the last line that it lost in a power failure.
      if (end + 1 == bytes.size() && text.find('\0') != std::string_view::npos) break;
      fail_line(file, found.lines.size() + 1, "is not a JSON object: the line was changed");
    }
    found.lines.push_back({text, std::move(json)});
    found.complete = end + 1;
  }
  return found;
}

bool follows(const LogLine& line, std::string_view mac) {
  const auto previous = line.json.find("previous");
  return previous != line.json.end() && previous->is_string() && previous->get<std::string>() == mac;
}

/// Names the first line that was changed, or that does not follow the line before it.
void check_chain(const fs::path& file, const std::vector<LogLine>& lines, const LogKey& key) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i == 0 && !follows(lines[i], key.lock_hash)) {
      fail_line(
          file, 1,
          "\"previous\" is not the hash of lock.json: the line was changed, or the log is of another study");
    }
    if (lines[i].mac().empty() || hmac_sha256(key.mac_key, lines[i].signed_text()) != lines[i].mac()) {
      fail_line(file, i + 1, "was changed: its mac does not fit");
    }
    if (i > 0 && !follows(lines[i], lines[i - 1].mac())) {
      fail_line(file, i + 1, fmt::format("does not follow line {}: a line between them was removed", i));
    }
  }
}

/// The end that a log had before its lines were deleted; empty: it has lines.
std::optional<LogHead> head_before_deletion(const LogLines& found) {
  if (found.lines.size() != 1) return std::nullopt;
  const LogLine& line = found.lines.front();
  const auto event = line.json.find("event");
  if (event == line.json.end() || *event != kDeletedEvent) return std::nullopt;
  return deletion_of(event_of(JsonField(line.json), line.text)).before;
}

/// A log may be longer than its head, where a process was killed before it wrote the head.
void check_head(const fs::path& file, const LogLines& found, const LogHead& head) {
  if (found.lines.size() < head.lines) {
    throw InputError(fmt::format("{}: has {}, must have {}: lines at its end were removed", file.string(),
                                 counted(found.lines.size(), "line", "lines"), head.lines));
  }
  if (head.lines > 0 && found.lines[head.lines - 1].mac() != head.mac) {
    fail_line(file, head.lines, "is not the line that was written: the log was replaced from here on");
  }
}

void add_line(ParticipantLog& log, const LogLine& line, std::size_t number) {
  const JsonField json(line.json);
  if (json.at("n").whole<std::uint64_t>() != number) {
    throw InputError(fmt::format("n must be {}, the number of the line", number));
  }
  const JsonField type = json.at("type");
  if (type.text() == "trial") {
    log.trials.push_back(trial_of(json));
  } else if (type.text() == "event") {
    log.events.push_back(event_of(json, line.text));
  } else {
    type.fail("trial or event");
  }
}

ParticipantLog parse_log(const fs::path& file, std::string_view bytes, const LogKey& key,
                         const std::optional<LogHead>& head) {
  const LogLines found = split_log(file, bytes);
  check_chain(file, found.lines, key);
  // A process that was killed between the new log and its head leaves the old head.
  if (head && head_before_deletion(found) != head) check_head(file, found, *head);
  ParticipantLog log;
  log.id = file.stem().string();
  log.last_mac = found.lines.empty() ? key.lock_hash : std::string(found.lines.back().mac());
  log.cut = found.complete < bytes.size();
  for (std::size_t i = 0; i < found.lines.size(); ++i) {
    try {
      const std::size_t before = log.trials.size();
      const std::size_t events = log.events.size();
      add_line(log, found.lines[i], i + 1);
      if (log.events.size() > events) log.events.back().after_trials = before;
    } catch (const std::exception& error) {
      fail_line(file, i + 1, one_line(error.what()));
    }
  }
  return log;
}

std::string reason() { return std::strerror(errno); }

/// Writes all bytes at an offset, and flushes them to the disk.
bool write_through(int descriptor, std::string_view bytes, std::uint64_t offset, bool flush = true) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return !flush || ::fdatasync(descriptor) == 0;
}

std::string read_bytes(const fs::path& file) { return InputFile(file, kLogInput).read_rest(); }

}  // namespace

std::string utc_now() {
  constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
  return utc_time(unix_ns() / kNanosecondsPerMillisecond);
}

std::string utc_time(std::int64_t milliseconds) {
  const auto seconds = static_cast<std::time_t>(milliseconds / 1000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, milliseconds % 1000);
}

double seconds_of(const std::string& time) {
  std::tm parts{};
  double seconds = 0.0;
  const int read = std::sscanf(time.c_str(), "%4d-%2d-%2dT%2d:%2d:%lf", &parts.tm_year, &parts.tm_mon,
                               &parts.tm_mday, &parts.tm_hour, &parts.tm_min, &seconds);
  if (read != 6) return 0.0;
  parts.tm_year -= 1900;
  parts.tm_mon -= 1;
  return static_cast<double>(timegm(&parts)) + seconds;
}

std::string EventRecord::value(const std::string& name) const {
  const auto found =
      std::find_if(values.begin(), values.end(), [&](const auto& entry) { return entry.first == name; });
  return found == values.end() ? "" : found->second;
}

std::size_t ParticipantLog::finished_sessions() const {
  return static_cast<std::size_t>(std::count_if(
      events.begin(), events.end(), [](const EventRecord& event) { return event.event == "session-end"; }));
}

bool ParticipantLog::withdrawn() const {
  return std::any_of(events.begin(), events.end(),
                     [](const EventRecord& event) { return event.event == "withdrawn"; });
}

std::optional<Deletion> ParticipantLog::deletion() const {
  if (lines() != 1 || events.empty() || events.front().event != kDeletedEvent) return std::nullopt;
  return deletion_of(events.front());
}

ParticipantLog read_log(const fs::path& file, const LogKey& key) {
  // The head first: a session that runs meanwhile makes the log longer.
  std::optional<LogHead> head;
  if (!key.heads.empty()) head = LogHeads(key.heads).read(key.number, key.mac_key);
  return parse_log(file, file_or_link_exists(file) ? read_bytes(file) : "", key, head);
}

EventRecord deleted_event(const Deletion& deletion) {
  return {deletion.time,
          kDeletedEvent,
          {{"reason", deletion.reason},
           {"lines", std::to_string(deletion.before.lines)},
           {"last_mac", deletion.before.mac},
           {"log", deletion.damaged ? kDamagedLog : "consistent"}}};
}

fs::path cut_lines_of(fs::path log) { return log.replace_extension(".cut"); }

LogWriter::LogWriter(fs::path file, LogKey key, Sync sync)
    : file_(std::move(file)), key_(std::move(key)), sync_(sync) {
  if (!key_.heads.empty()) heads_.emplace(key_.heads, LogHeads::Use::kAppend);
  open_and_lock();
  try {
    remove_cut_line();
    write_head();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

LogWriter::~LogWriter() {
  if (sync_ == Sync::kAtEnd) ::fdatasync(descriptor_);
  ::close(descriptor_);  // also releases the lock
}

void LogWriter::open_and_lock() {
  constexpr mode_t kRights = 0644;
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, kRights);
  if (descriptor_ < 0) throw InputError(file_.string() + ": cannot be opened for writing: " + reason());
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const std::string why = errno == EWOULDBLOCK ? "another process has this log open: end that session first"
                                               : "cannot be locked: " + reason();
  ::close(descriptor_);
  throw InputError(file_.string() + ": " + why);
}

void LogWriter::remove_cut_line() {
  const std::string bytes = read_bytes(file_);
  const auto head = heads_ ? std::optional(heads_->read(key_.number, key_.mac_key)) : std::nullopt;
  opened_ = parse_log(file_, bytes, key_, head);
  size_ = split_log(file_, bytes).complete;
  lines_ = opened_.lines();
  last_mac_ = opened_.last_mac;
  if (const auto deletion = opened_.deletion()) {
    throw InputError(fmt::format("{}: the data of {} were deleted on {}, and nobody else gets this id",
                                 file_.string(), opened_.id, deletion->time.substr(0, kDateDigits)));
  }
  flush_folder(file_.parent_path());
  if (!opened_.cut) return;
  const fs::path kept = cut_lines_of(file_);
  constexpr mode_t kRights = 0644;
  const int descriptor = ::open(kept.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, kRights);
  if (descriptor < 0) throw InputError(kept.string() + ": cannot be opened for writing: " + reason());
  std::string tail = bytes.substr(size_);
  if (!tail.ends_with('\n')) tail += '\n';
  const off_t end = ::lseek(descriptor, 0, SEEK_END);
  const bool written = end >= 0 && write_through(descriptor, tail, static_cast<std::uint64_t>(end));
  const std::string why = reason();
  ::close(descriptor);
  if (!written) throw InputError(kept.string() + ": cannot be written: " + why);
  if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0 || ::fdatasync(descriptor_) != 0) {
    throw InputError(file_.string() + ": the incomplete last line cannot be removed: " + reason());
  }
}

void LogWriter::append(const TrialRecord& trial) { append_line(dumped(json_of_trial(trial))); }

void LogWriter::append(const EventRecord& event) { append_line(dumped(json_of_event(event))); }

void LogWriter::append_line(const std::string& json_without_chain) {
  std::string line = fmt::format(R"({{"n":{},"previous":"{}",{})", lines_ + 1, last_mac_,
                                 std::string_view(json_without_chain).substr(1));
  line.pop_back();  // the closing bracket
  const std::string mac = hmac_sha256(key_.mac_key, line);
  line.append(kMacStart).append(mac).append(kMacEnd);
  if (!write_through(descriptor_, line + '\n', size_, sync_ == Sync::kEachLine)) {
    const std::string why = reason();
    static_cast<void>(::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0);
    throw InputError(file_.string() + ": cannot be written: " + why);
  }
  size_ += line.size() + 1;
  ++lines_;
  last_mac_ = mac;
  write_head();
}

// After the line, so that the log always reaches its head.
void LogWriter::write_head() {
  if (heads_) heads_->write(key_.number, {lines_, last_mac_}, key_.mac_key);
}

}  // namespace palpate::study
