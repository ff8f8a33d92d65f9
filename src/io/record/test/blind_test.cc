// Recordings of a study that is still blind.
#include "io/record/blind.h"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/record/flight_recorder.h"
#include "io/record/test/sample_recording.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kUnblinded = "{\"time\":\"2026\",\"proof\":\"the proof\"}\n";

/// A study's folder with one blind recording.
struct Study {
  Study() {
    fs::create_directory(folder / "recordings");
    Recorder recorder(file, scene, true, {}, mark);
    recorder.on_start(kStarted);
    for (std::uint64_t tick = 0; tick < 5; ++tick) recorder.on_row(sample_row(tick, 0));
    recorder.finish({});
  }
  void unblind() const { std::ofstream(folder / "unblinded.json") << kUnblinded; }
  [[nodiscard]] fs::path log() const { return folder / "recordings" / "blind-broken.jsonl"; }

  TemporaryFolder folder;
  StudyMark mark{"touch-noise-1", sha256("the proof")};
  scene::Scene scene = sample_setup(1);
  fs::path file = folder / "recordings" / "block-1.h5";
};

TEST(BlindRecording, IsRefusedWithTheReasonAndTheWaysToOpenIt) {
  const Study study;
  EXPECT_THAT(
      [&] { (void)read_recording(study.file); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("block-1.h5: belongs to the study touch-noise-1"),
                                      HasSubstr("palpate study unblind"), HasSubstr("--break-blind"))));
}

TEST(BlindRecording, WhoseFolderCannotBeFoundIsAnErrorInWords) {
  const Study study;
  EXPECT_THAT([&] { (void)is_unblinded(study.folder / "recordings/gone.h5", study.mark); },
              ThrowsMessage<InputError>(HasSubstr("gone.h5: its folder cannot be found: No such file")));
}

/// In a child process whose files may have at most 10 bytes: breaks the blind. @return whether the error says
/// that there was no space for the line
bool says_there_is_no_space(const Study& study) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit small{10, 10};
    ::setrlimit(RLIMIT_FSIZE, &small);
    std::string why;
    try {
      log_broken_blind(study.file, "export");
    } catch (const InputError& error) {
      why = error.what();
    }
    ::_exit(why.ends_with("stays blind: there is no space for the whole line") ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(BlindRecording, ANoteThatIsCutOffIsNoNoteAndTheErrorSaysWhy) {
  const Study study;
  EXPECT_TRUE(says_there_is_no_space(study));
}

TEST(BlindRecording, IsReadByACallerThatShowsNoForce) {
  const Study study;
  const Recording recording = read_recording(study.file, {}, Blind::kAllow);
  EXPECT_EQ(recording.rows.size(), 5U);
  EXPECT_EQ(recording.facts.study, study.mark);
  EXPECT_TRUE(recording.facts.blind);
}

TEST(BlindRecording, IsOpenedByTheFileAboveItsFolder) {
  const Study study;
  std::ofstream(study.folder / "recordings" / "unblinded.json") << kUnblinded;
  EXPECT_THROW((void)read_recording(study.file), InputError) << "beside it the file does not count";
  study.unblind();
  const Recording recording = read_recording(study.file);
  EXPECT_EQ(recording.facts.study, study.mark);
  EXPECT_FALSE(recording.facts.blind);
}

TEST(BlindRecording, ACopyBesideAForgedFileIsAsBlind) {
  const Study study;
  const TemporaryFolder other;
  fs::create_directory(other / "recordings");
  const fs::path copy = other / "recordings" / "block-1.h5";
  fs::copy_file(study.file, copy);
  for (const std::string& forged :
       {std::string("{}\n"), std::string(), std::string("{\"proof\":\"a proof\"}"),
        std::string("{\"proof\":7}"), "{\"proof\":\"" + study.mark.commitment + "\"}",
        std::string(300'000, '['), std::string("[]")}) {
    std::ofstream(other / "unblinded.json") << forged;
    EXPECT_THROW((void)read_recording(copy), InputError) << forged.substr(0, 40);
  }
  std::ofstream(other / "unblinded.json") << kUnblinded;
  EXPECT_FALSE(read_recording(copy).facts.blind) << "the study's own file was copied, too";
}

TEST(BlindRecording, OfAnOlderPalpateWithoutACommitmentStaysBlind) {
  Study study;
  study.mark.commitment.clear();
  {
    Recorder recorder(study.file, study.scene, true, {}, study.mark);
    recorder.on_start(kStarted);
    recorder.on_row(sample_row(0, 0));
    recorder.finish({});
  }
  study.unblind();
  EXPECT_THROW((void)read_recording(study.file), InputError);
}

TEST(BlindRecording, AFileThatCannotBeLookedAtIsAnError) {
  const Study study;
  fs::create_symlink("unblinded.json", study.folder / "unblinded.json");
  EXPECT_THAT([&] { (void)read_recording(study.file); },
              ThrowsMessage<InputError>(HasSubstr("unblinded.json: cannot be looked at")));
}

TEST(BlindRecording, ALinkToItIsAsBlind) {
  const Study study;
  const TemporaryFolder other;
  fs::create_directory(other / "recordings");
  std::ofstream(other / "unblinded.json") << kUnblinded;
  fs::create_symlink(study.file, other / "recordings" / "link.h5");
  EXPECT_THROW((void)read_recording(other / "recordings" / "link.h5"), InputError);
}

TEST(BlindRecording, ARecordingOfNoStudyIsNotBlind) {
  const TemporaryFolder folder;
  record_sample(folder / "a.h5", 5, 1);
  const Recording recording = break_blind(folder / "a.h5", "palpate export");
  EXPECT_EQ(recording.facts.study, StudyMark{});
  EXPECT_FALSE(recording.facts.blind);
  EXPECT_FALSE(fs::exists(folder / "blind-broken.jsonl")) << "nothing was broken";
}

TEST(BlindRecording, BreakingTheBlindAppendsALineEachTime) {
  const Study study;
  EXPECT_EQ(break_blind(study.file, "palpate export").rows.size(), 5U);
  EXPECT_FALSE(break_blind(study.file, "palpate view").facts.blind);
  std::istringstream lines(contents(study.log()));
  std::vector<nlohmann::json> entries;
  for (std::string line; std::getline(lines, line);) entries.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0]["event"], "break-blind");
  EXPECT_EQ(entries[0]["file"], "block-1.h5");
  EXPECT_EQ(entries[0]["command"], "palpate export");
  EXPECT_EQ(entries[1]["command"], "palpate view");
  EXPECT_THAT(entries[0]["time"].get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:..Z"));
  study.unblind();
  (void)break_blind(study.file, "palpate view");
  EXPECT_EQ(contents(study.log()), lines.str()) << "an open recording is not broken";
}

TEST(BlindRecording, WithoutALogItStaysBlind) {
  const Study study;
  fs::create_directory(study.log());
  EXPECT_THAT([&] { (void)break_blind(study.file, "palpate export"); },
              ThrowsMessage<InputError>(HasSubstr("blind-broken.jsonl: cannot be written")));
}

TEST(BlindRecording, ALogThatIsALinkIsNotFollowed) {
  const Study study;
  fs::create_symlink(study.folder / "elsewhere", study.log());
  EXPECT_THROW((void)break_blind(study.file, "palpate export"), InputError);
  EXPECT_FALSE(fs::exists(study.folder / "elsewhere"));
}

TEST(BlindRecording, RepairKeepsItBlind) {
  const Study study;
  {
    Recorder recorder(study.file, study.scene, true, {}, study.mark);
    recorder.on_start(kStarted);
    for (std::uint64_t tick = 0; tick < 3000; ++tick) recorder.on_row(sample_row(tick, 0));
    recorder.finish({});
  }
  fs::resize_file(study.file, fs::file_size(study.file) - 300'000);
  EXPECT_TRUE(repair_recording(study.file).was_damaged);
  EXPECT_TRUE(opens_plainly(study.file));
  EXPECT_THROW((void)read_recording(study.file), InputError);
  EXPECT_GT(read_recording(study.file, {}, Blind::kAllow).rows.size(), 1000U);
}

TEST(BlindRecording, TheTicksBeforeAFaultAreBlindToo) {
  const TemporaryFolder folder;
  const scene::Scene scene = sample_setup(1);
  FlightRecorder flight(scene, {"touch-noise-1", ""});
  flight.on_row(sample_row(0, 0));
  flight.write(folder / "fault.h5", {});
  EXPECT_THROW((void)read_recording(folder / "fault.h5"), InputError);
}

TEST(BlindRecording, ADifferenceOfItsRowsIsReportedWithoutValues) {
  haptics::TickRow other = sample_row(3, 0);
  other.noise_force += 0.25;
  EXPECT_EQ(row_difference(sample_row(3, 0), other, false), "tick 3, hand 0, noise_force_N");
  EXPECT_THAT(row_difference(sample_row(3, 0), other), HasSubstr("noise_force_N: recorded "));
}

}  // namespace
}  // namespace palpate::record
