#include "study/session/trial_log.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/random.h"
#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "io/system/temporary.h"

#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kLock(64, 'a');
const LogKey kLogKey{kLock, "key of the log"};

/// A line with its mac, as docs/file-formats.md states it.
std::string with_mac(const std::string& json) {
  const std::string text = json.substr(0, json.size() - 1);
  return text + R"(,"mac":")" + hmac_sha256(kLogKey.mac_key, text) + "\"}\n";
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
    LogWriter writer(file_, kLogKey);
    for (const char* name : {"consent", "session", "note"}) writer.append(EventRecord{"2026", name, {}});
    bytes_ = bytes_of(file_);
  }
  [[nodiscard]] std::string read_error(const std::string& bytes) const {
    write_output(file_, bytes);
    return error_of([&] { static_cast<void>(read_log(file_, kLogKey)); });
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

TEST_F(TrialLog, OfRandomRecordsReadsBackToTheSameRecords) {
  constexpr std::uint64_t kSeed = 20260301;
  const fs::path file = folder_.path() / "PRAND.jsonl";
  std::vector<TrialRecord> trials;
  std::vector<EventRecord> events;
  for (std::uint32_t run = 0; run < 8; ++run) {  // opened again for each run
    LogWriter writer(file, kLogKey);
    EXPECT_EQ(writer.opened().trials, trials);
    for (std::uint32_t i = 0; i < 10; ++i) {
      Random random(kSeed, run, i);
      writer.append(trials.emplace_back(any_trial(random)));
      writer.append(events.emplace_back(any_event(random)));
    }
  }
  const ParticipantLog log = read_log(file, kLogKey);
  EXPECT_EQ(log.id, "PRAND");
  EXPECT_EQ(log.trials, trials);
  EXPECT_EQ(log.events, events);
  EXPECT_FALSE(log.cut);
}

TEST_F(TrialLog, ThatDoesNotExistIsEmpty) {
  const ParticipantLog log = read_log(folder_.path() / "PNONE.jsonl", kLogKey);
  EXPECT_TRUE(log.trials.empty() && log.events.empty());
  EXPECT_EQ(log.last_mac, kLock);
}

TEST_F(TrialLog, HoldsInEachLineItsMacAndTheMacOfTheLineBefore) {
  const std::string first =
      R"({"n":1,"previous":")" + kLock + R"(","type":"event","time":"2026","event":"consent"})";
  EXPECT_EQ(bytes_.substr(0, start_of(2)), with_mac(first));
  const std::string mac = hmac_sha256("key of the log", first.substr(0, first.size() - 1));
  EXPECT_THAT(bytes_.substr(start_of(2)), StartsWith(R"({"n":2,"previous":")" + mac + '"'));
}

TEST_F(TrialLog, NamesTheLineOfAnyChangedByte) {
  for (const int line : {1, 2, 3}) {
    const std::size_t end = line == 3 ? bytes_.size() - 1 : start_of(line + 1);  // not the last line's end
    for (std::size_t at = start_of(line); at < end; ++at) {
      std::string changed = bytes_;
      changed[at] = static_cast<char>(changed[at] ^ 1);
      EXPECT_THAT(read_error(changed), StartsWith(file_.string() + ":" + std::to_string(line) + ": "))
          << "byte " << at;
    }
  }
}

TEST_F(TrialLog, NamesTheLineAfterARemovedOne) {
  EXPECT_EQ(read_error(bytes_.substr(0, start_of(2)) + bytes_.substr(start_of(3))),
            file_.string() + ":2: does not follow line 1: a line between them was removed");
}

TEST_F(TrialLog, ThatWasForgedWithoutTheKeyIsRefused) {
  fs::remove(file_);
  {
    LogWriter forger(file_, {kLock, "another key"});
    forger.append(EventRecord{"2026", "consent", {}});
  }
  EXPECT_EQ(read_error(bytes_of(file_)), file_.string() + ":1: was changed: its mac does not fit");
}

/// A log whose head is in a file heads.txt of two lines.
class LogWithHead : public TrialLog {
 protected:
  LogWithHead() {
    write_output(key_.heads,
                 LogHeads::text_of({0, kLock}, "of the study") + LogHeads::text_of({0, kLock}, key_.mac_key));
    LogWriter writer(log_, key_);
    for (int i = 0; i < 3; ++i) writer.append(EventRecord{"2026", "note", {}});
  }
  [[nodiscard]] std::string read_head_error(const LogKey& key) const {
    return error_of([&] { static_cast<void>(read_log(log_, key)); });
  }
  LogKey key_{kLock, "key of the log", folder_.path() / "heads.txt", 1};
  fs::path log_ = folder_.path() / "PHEAD.jsonl";
};

TEST_F(LogWithHead, WithoutItsLastLinesOrAltogetherIsRefused) {
  EXPECT_EQ(read_log(log_, key_).events.size(), 3U);
  const std::string bytes = bytes_of(log_);
  const std::size_t second = bytes.find('\n') + 1;
  write_output(log_, bytes.substr(0, second));
  EXPECT_EQ(read_head_error(key_),
            log_.string() + ": has 1 line, must have 3: lines at its end were removed");
  EXPECT_EQ(error_of([&] { const LogWriter writer(log_, key_); }), read_head_error(key_));
  fs::remove(log_);
  EXPECT_EQ(read_head_error(key_),
            log_.string() + ": has 0 lines, must have 3: lines at its end were removed");
}

TEST_F(LogWithHead, MayBeLongerThanItsHeadAfterACrash) {
  const std::string heads = bytes_of(key_.heads);
  LogWriter(log_, key_).append(EventRecord{"2026", "note", {}});
  write_output(key_.heads, heads);  // killed after the line and before the head
  EXPECT_EQ(read_log(log_, key_).events.size(), 4U);
  { const LogWriter writer(log_, key_); }
  EXPECT_EQ(LogHeads(key_.heads).read(1, key_.mac_key).lines, 4U) << "the next session writes it";
}

TEST_F(LogWithHead, WithAHeadThatWasChangedIsRefused) {
  std::string heads = bytes_of(key_.heads);
  ASSERT_EQ(heads.size(), 512U);
  ASSERT_EQ(heads[256], '3');
  heads[256] = '1';
  write_output(key_.heads, heads);
  EXPECT_EQ(read_head_error(key_), key_.heads.string() + ":2: was changed: its mac does not fit");
  fs::remove(key_.heads);
  EXPECT_EQ(read_head_error(key_), key_.heads.string() + ": cannot be opened: No such file or directory");
}

TEST_F(LogWithHead, KeepsOutWhoUnblindsWhileItIsOpen) {
  {
    const LogWriter writer(log_, key_);
    EXPECT_EQ(error_of([&] { const LogHeads heads(key_.heads, LogHeads::Use::kUnblind); }),
              key_.heads.string() + ": a session is running: end it first");
  }
  const LogHeads heads(key_.heads, LogHeads::Use::kUnblind);
  EXPECT_EQ(error_of([&] { const LogWriter writer(log_, key_); }),
            key_.heads.string() + ": the study is just being unblinded");
}

TEST_F(TrialLog, OfAnotherStudyIsRefused) {
  EXPECT_EQ(error_of([&] {
              static_cast<void>(read_log(file_, {std::string(64, 'b'), kLogKey.mac_key}));
            }),
            file_.string() +
                ":1: \"previous\" is not the hash of lock.json: the line was changed, or the log "
                "is of another study");
}

TEST_F(TrialLog, WithAMalformedLineIsRefused) {
  EXPECT_EQ(read_error(bytes_ + "{]\n"), file_.string() + ":4: is not a JSON object: the line was changed");
  const std::string start = R"({"n":1,"previous":")" + kLock + R"(",)";
  EXPECT_EQ(read_error(with_mac(start + R"("type":"other"})")),
            file_.string() + ":1: type = \"other\": must be trial or event");
  EXPECT_EQ(read_error(with_mac(start + R"("type":"trial"})")),
            file_.string() + ":1: time: missing, must be a text");
  EXPECT_EQ(read_error(with_mac(start + R"("type":"trial","time":"","session":4294967297})")),
            file_.string() + ":1: session = 4294967297: must be a whole number from 0 to 65535");
  EXPECT_EQ(read_error(with_mac(R"({"n":2,"previous":")" + kLock + "\"}")),
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
    EXPECT_TRUE(read_log(file_, kLogKey).cut);
    {
      LogWriter writer(file_, kLogKey);
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
  EXPECT_EQ(LogWriter(file_, kLogKey).opened().events.size(), 3U);
  EXPECT_EQ(bytes_of(file_), bytes_);
  EXPECT_EQ(bytes_of(folder_.path() / "PABCD.cut"), zeros + "\n");
}

TEST_F(TrialLog, RefusesASecondProcess) {
  const LogWriter writer(file_, kLogKey);
  const pid_t child = fork();
  if (child == 0) {
    const std::string error = error_of([&] { const LogWriter second(file_, kLogKey); });
    _exit(error == file_.string() + ": another process has this log open: end that session first" ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(TrialLog, RefusesValuesThatItCannotRepresent) {
  LogWriter writer(file_, kLogKey);
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
  EXPECT_EQ(error_of([&] { const LogWriter writer(file, kLogKey); }),
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
}  // namespace palpate::study
