#include "science/experiment/trial_log.h"

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/random.h"
#include "io/system/output_file.h"
#include "io/system/temporary.h"
#include "science/experiment/test/study_text.h"

namespace palpate::experiment {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kLock(64, 'a');

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A finite double of random bits.
double any_double(Random& random) {
  for (;;) {
    const auto high = static_cast<std::uint64_t>(random.uniform() * 0x1p32);
    const auto low = static_cast<std::uint64_t>(random.uniform() * 0x1p32);
    const auto value = std::bit_cast<double>(high << 32 | low);
    if (std::isfinite(value)) return value;
  }
}

std::string any_text(Random& random) {
  const std::vector<std::string> pieces{"a", "\"", "\\", "\n", "\t", "µ", "日", "{", "}", " ", "\x01"};
  std::string text;
  for (std::size_t i = random.below(6); i > 0; --i) text += pieces[random.below(pieces.size())];
  return text;
}

TrialRecord any_trial(Random& random) {
  TrialRecord trial;
  trial.time = utc_now();
  trial.session = static_cast<int>(random.below(9));
  trial.block = static_cast<int>(random.below(99));
  trial.task = any_text(random);
  trial.repeat = random.below(2) == 1;
  trial.practice = random.below(2) == 1;
  trial.catch_trial = random.below(2) == 1;
  trial.number = static_cast<int>(random.below(1000));
  trial.code = "c" + std::to_string(random.below(6) + 1);
  trial.level = any_double(random);
  trial.second = random.below(2) == 1;
  trial.answer = static_cast<int>(random.below(3));
  trial.counted = random.below(2) == 1;
  trial.response_time = any_double(random);
  for (std::size_t i = random.below(3); i > 0; --i) trial.spoiled.push_back(any_text(random));
  for (IntervalCues& cues : trial.intervals) {
    cues.from_tick = static_cast<std::uint64_t>(random.uniform() * 0x1p64);
    cues.to_tick = std::numeric_limits<std::uint64_t>::max();
    cues.peak_force = any_double(random);
    cues.mean_force = any_double(random);
    cues.depth = any_double(random);
    cues.work = any_double(random);
  }
  trial.rms_error = any_double(random);
  trial.variation = any_double(random);
  trial.observer = any_text(random);
  return trial;
}

EventRecord any_event(Random& random) {
  EventRecord event{utc_now(), any_text(random), {}};
  for (std::size_t i = random.below(4); i > 0; --i) {
    event.values.emplace_back(std::to_string(i) + any_text(random), any_text(random));
  }
  return event;
}

/// A log of three events in a folder of its own.
class TrialLog : public testing::Test {
 protected:
  void SetUp() override {
    LogWriter writer(file_, kLock);
    for (const char* name : {"consent", "session", "note"}) writer.append(EventRecord{"2026", name, {}});
    bytes_ = bytes_of(file_);
  }
  [[nodiscard]] std::string read_error(const std::string& bytes) const {
    write_output(file_, bytes);
    return error_of([&] { static_cast<void>(read_log(file_, kLock)); });
  }
  /// Start of a line's bytes.
  [[nodiscard]] std::size_t start_of(int line) const {
    std::size_t start = 0;
    for (int i = 1; i < line; ++i) start = bytes_.find('\n', start) + 1;
    return start;
  }

  ScratchFolder folder_{"palpate-log"};
  fs::path file_ = folder_.path() / "PABCD.jsonl";
  std::string bytes_;
};

// FIPS 180-2, appendix B.1.
TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(TrialLog, OfRandomRecordsReadsBackToTheSameRecords) {
  constexpr std::uint64_t kSeed = 20260301;
  const fs::path file = folder_.path() / "PRAND.jsonl";
  std::vector<TrialRecord> trials;
  std::vector<EventRecord> events;
  for (std::uint32_t run = 0; run < 8; ++run) {  // opened again for each run
    LogWriter writer(file, kLock);
    EXPECT_EQ(writer.opened().trials, trials);
    for (std::uint32_t i = 0; i < 10; ++i) {
      Random random(kSeed, run, i);
      writer.append(trials.emplace_back(any_trial(random)));
      writer.append(events.emplace_back(any_event(random)));
    }
  }
  const ParticipantLog log = read_log(file, kLock);
  EXPECT_EQ(log.id, "PRAND");
  EXPECT_EQ(log.trials, trials);
  EXPECT_EQ(log.events, events);
  EXPECT_FALSE(log.cut);
}

TEST_F(TrialLog, ThatDoesNotExistIsEmpty) {
  const ParticipantLog log = read_log(folder_.path() / "PNONE.jsonl", kLock);
  EXPECT_TRUE(log.trials.empty() && log.events.empty());
  EXPECT_EQ(log.last_hash, kLock);
}

TEST_F(TrialLog, HoldsInEachLineTheHashOfTheLineBefore) {
  const std::string first = bytes_.substr(0, start_of(2) - 1);
  EXPECT_THAT(first, StartsWith(R"({"n":1,"previous":")" + kLock + R"(","type":"event","time":"2026",)"));
  EXPECT_THAT(bytes_.substr(start_of(2)), StartsWith(R"({"n":2,"previous":")" + sha256(first) + '"'));
}

TEST_F(TrialLog, NamesTheLineOfAnyChangedByteBeforeTheLastLine) {
  for (const int line : {1, 2}) {
    for (std::size_t at = start_of(line); at < start_of(line + 1); ++at) {
      std::string changed = bytes_;
      changed[at] = static_cast<char>(changed[at] ^ 1);
      EXPECT_THAT(read_error(changed), StartsWith(file_.string() + ":" + std::to_string(line) + ": "))
          << "byte " << at;
    }
  }
}

TEST_F(TrialLog, NamesTheLineBeforeARemovedOne) {
  EXPECT_EQ(read_error(bytes_.substr(0, start_of(2)) + bytes_.substr(start_of(3))),
            file_.string() + ":1: this line or line 2 was changed: their hashes do not match");
}

TEST_F(TrialLog, OfAnotherStudyIsRefused) {
  EXPECT_EQ(error_of([&] { static_cast<void>(read_log(file_, std::string(64, 'b'))); }),
            file_.string() + ":1: \"previous\" is not the hash of lock.json: the log is of another study");
}

TEST_F(TrialLog, WithAMalformedLineIsRefused) {
  EXPECT_EQ(read_error(bytes_ + "{]\n"), file_.string() + ":4: is not a JSON object: the line was changed");
  const std::string start = R"({"n":1,"previous":")" + kLock + R"(",)";
  EXPECT_EQ(read_error(start + "\"type\":\"other\"}\n"),
            file_.string() + ":1: type = \"other\": must be trial or event");
  EXPECT_EQ(read_error(start + "\"type\":\"trial\"}\n"),
            file_.string() + ":1: time: missing, must be a text");
  EXPECT_EQ(read_error(start + "\"type\":\"trial\",\"time\":\"\",\"session\":4294967297}\n"),
            file_.string() + ":1: session = 4294967297: must be a whole number from 0 to 65535");
  EXPECT_EQ(read_error(R"({"n":2,"previous":")" + kLock + "\"}\n"),
            file_.string() + ":1: n must be 1, the number of the line");
}

TEST_F(TrialLog, WithALineNestedSoDeepThatACopyWouldTakeTheStackIsRefused) {
  EXPECT_EQ(read_error(bytes_ + "{\"z\":" + std::string(300'000, '[') + std::string(300'000, ']') + "}\n"),
            file_.string() + ":4: is not a JSON object: the line was changed");
}

TEST_F(TrialLog, CutAnywhereInItsLastLineLosesOnlyThisLine) {
  for (std::size_t size = start_of(3) + 1; size < bytes_.size(); ++size) {
    write_output(file_, bytes_.substr(0, size));
    fs::remove(cut_lines_of(file_));
    EXPECT_TRUE(read_log(file_, kLock).cut);
    {
      LogWriter writer(file_, kLock);
      EXPECT_EQ(writer.opened().events.size(), 2U);
      writer.append(EventRecord{"2026", "note", {}});
    }
    EXPECT_EQ(bytes_of(file_), bytes_) << size;
    EXPECT_EQ(bytes_of(cut_lines_of(file_)), bytes_.substr(start_of(3), size - start_of(3)) + "\n");
  }
}

TEST_F(TrialLog, MovesALastLineOfZerosToAFileBesideIt) {
  const std::string zeros(100, '\0');
  write_output(file_, bytes_ + zeros + "\n");
  EXPECT_EQ(LogWriter(file_, kLock).opened().events.size(), 3U);
  EXPECT_EQ(bytes_of(file_), bytes_);
  EXPECT_EQ(bytes_of(folder_.path() / "PABCD.cut"), zeros + "\n");
}

TEST_F(TrialLog, RefusesASecondProcess) {
  const LogWriter writer(file_, kLock);
  const pid_t child = fork();
  if (child == 0) {
    const std::string error = error_of([&] { const LogWriter second(file_, kLock); });
    _exit(error == file_.string() + ": another process has this log open: end that session first" ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(TrialLog, RefusesValuesThatItCannotRepresent) {
  LogWriter writer(file_, kLock);
  TrialRecord trial;
  trial.rms_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { writer.append(trial); }), StartsWith("rms_error_N = nan: must be finite"));
  EXPECT_EQ(error_of([&] {
              writer.append(EventRecord{"", "note", {{"n", "1"}}});
            }),
            "event note: value n: the name is taken, must be another");
  EXPECT_EQ(bytes_of(file_), bytes_);
}

TEST_F(TrialLog, NamesAFileThatCannotBeWritten) {
  const fs::path file = folder_.path() / "absent" / "P.jsonl";
  EXPECT_EQ(error_of([&] { const LogWriter writer(file, kLock); }),
            file.string() + ": cannot be opened for writing: No such file or directory");
}

TEST(ParticipantLog, IsWithdrawnAfterThatEvent) {
  ParticipantLog log;
  EXPECT_FALSE(log.withdrawn());
  log.events.push_back({"", "withdrawn", {{"why", "tired"}}});
  EXPECT_TRUE(log.withdrawn());
  EXPECT_EQ(log.events[0].value("why"), "tired");
  EXPECT_EQ(log.events[0].value("who"), "");
}

}  // namespace
}  // namespace palpate::experiment
