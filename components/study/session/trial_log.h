#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/session/log_heads.h"

namespace palpate::study {

/// What the hand felt and did in an interval, without the noise: for the analysis of cues.
struct IntervalCues {
  std::uint64_t from_tick = 0;
  std::uint64_t to_tick = 0;  // first tick after it
  double peak_force = 0.0;    // N, tissue force
  double mean_force = 0.0;    // N, tissue force
  double depth = 0.0;         // m, largest
  double work = 0.0;          // J, of the hand

  bool operator==(const IntervalCues&) const = default;
};

/// One trial of the log. It never holds the noise of a condition, only the code.
struct TrialRecord {
  std::string time;  // ISO 8601, UTC
  int session = 1;
  int block = 1;  // haptic run within the session
  std::string task;
  bool repeat = false;  // of the task's repetition at the end of its session
  bool practice = false;
  bool catch_trial = false;
  int number = 0;                    // of the trial in its task (or its practice), from 0
  std::string code;                  // of the arm: "c1", "c2", ...
  double level = 0.0;                // of the stimulus, see grid_of(); kForceControl: target [N]
  bool second = false;               // the signal, or the comparison, is in the second interval
  int answer = 0;                    // 1 or 2; 0: none
  bool counted = false;              // correct, or of a comparison "comparison is stiffer"
  double response_time = 0.0;        // s, from the end of the second interval
  std::vector<std::string> spoiled;  // reasons; empty: the trial counts
  std::array<IntervalCues, 2> intervals{};
  // kForceControl, after the first second of holding: root mean square error and coefficient of variation
  double rms_error = 0.0;  // N
  double variation = 0.0;
  std::string observer;  // simulated observer; empty: a person

  bool operator==(const TrialRecord&) const = default;
};

/// Another line of the log: "consent", "session", "resumed", "note", "blinding", "audible", "withdrawn", ...
struct EventRecord {
  std::string time;
  std::string event;
  // Names and values in the order they were given; texts as written in the file.
  std::vector<std::pair<std::string, std::string>> values;
  std::size_t after_trials = 0;  // number of trial lines before it; not compared

  [[nodiscard]] std::string value(const std::string& name) const;  // "" without such a name
  bool operator==(const EventRecord& other) const {
    return time == other.time && event == other.event && values == other.values;
  }
};

/// The key that authenticates the lines of a participant's log, and their start and end.
struct LogKey {
  std::string lock_hash;  // SHA-256 of lock.json; the first line follows it
  std::string mac_key;    // of this participant, from the sealed key
  // File of the logs' heads and the number of this log's in it; an empty path: the head is not kept
  std::filesystem::path heads{};
  std::size_t number = 0;
};

/// A person's data were deleted. It is the only line of the log then.
struct Deletion {
  std::string time;  // ISO 8601, UTC
  std::string reason;
  LogHead before;        // end of the deleted log
  bool damaged = false;  // the deleted log did not fit its chain

  bool operator==(const Deletion&) const = default;
};

using Deletions = std::vector<std::pair<std::string, Deletion>>;  // by id, in the order of the participants

/// All lines of a participant's log.
struct ParticipantLog {
  std::string id;
  std::vector<TrialRecord> trials;  // in the order of the file, spoiled ones and practice too
  std::vector<EventRecord> events;
  std::string last_mac;  // of the last line; of an empty file: the lock's hash
  // The last line was incomplete, without a line end or with zeros (crash), and is left out.
  bool cut = false;

  [[nodiscard]] std::size_t finished_sessions() const;
  [[nodiscard]] bool withdrawn() const;
  [[nodiscard]] std::optional<Deletion> deletion() const;
  [[nodiscard]] std::size_t lines() const noexcept { return trials.size() + events.size(); }
};

/// [setup] Reads a log and checks its chain. Each line ends with its mac, the HMAC-SHA-256 of the text before
/// it, and holds the mac of the line before it; the first one holds the lock's hash. The log must reach its
/// head (log_heads.h). A file that does not exist is an empty log. @throws InputError naming the file and the
/// line that is malformed, was changed or is missing
[[nodiscard]] ParticipantLog read_log(const std::filesystem::path& file, const LogKey& key);

/// [any] The line that ParticipantLog::deletion() reads.
[[nodiscard]] EventRecord deleted_event(const Deletion& deletion);

/// [any] The file that keeps incomplete last lines of a log: ID.cut beside ID.jsonl.
[[nodiscard]] std::filesystem::path cut_lines_of(std::filesystem::path log);

/// Appends lines to a participant's log. While it lives, another process can neither open the same log nor
/// unblind the study.
class LogWriter final {
 public:
  enum class Sync {
    kEachLine,  // a line is on the disk when append() returns
    kAtEnd      // of a simulated log
  };

  /// [setup] Opens the log, or creates it, and removes an incomplete last line after keeping it beside the
  /// file. @throws InputError when another process has it open, the study is unblinded or the person's data
  /// were deleted, or as read_log()
  LogWriter(std::filesystem::path file, LogKey key, Sync sync = Sync::kEachLine);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// [setup] What was in the log when it was opened.
  [[nodiscard]] const ParticipantLog& opened() const noexcept { return opened_; }

  /// [setup] Appends a line, which fdatasync brings to the disk. @throws InputError naming
  /// the file when it cannot be written
  void append(const TrialRecord& trial);
  void append(const EventRecord& event);

 private:
  void open_and_lock();
  void remove_cut_line();
  void append_line(const std::string& json_without_chain);
  void write_head();

  std::filesystem::path file_;
  LogKey key_;
  Sync sync_;
  std::optional<LogHeads> heads_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;   // bytes of complete lines
  std::uint64_t lines_ = 0;  // complete lines
  std::string last_mac_;
  ParticipantLog opened_;
};

/// [any] ISO 8601 UTC with milliseconds, of milliseconds since 1970.
[[nodiscard]] std::string utc_time(std::int64_t milliseconds);
/// [any] Seconds since 1970 of such a time; 0 when it is malformed.
[[nodiscard]] double seconds_of(const std::string& time);
/// [setup] The time now, ISO 8601 UTC with milliseconds.
[[nodiscard]] std::string utc_now();

}  // namespace palpate::study
