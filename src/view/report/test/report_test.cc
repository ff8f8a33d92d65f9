#include "view/report/report.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "view/report/page.h"
#include "view/report/test/synthetic_recording.h"

namespace palpate::report {
namespace {

using palpate::test::TemporaryFolder;
using test::SyntheticRecording;
using ::testing::HasSubstr;
using ::testing::Not;

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

constexpr ReportOptions kNoPictures{false, 0, 0};

/// One report of two experiments, without rendered pictures, for all tests here.
class Report : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const record::Recording press = SyntheticRecording::make();
    const record::Recording quiet = SyntheticRecording::make(false, 1200);
    const std::vector<Experiment> experiments{{"A box pressed & held", &press, "palpate run --seed <1>"},
                                              {"A box touched", &quiet, "palpate run --no-noise"}};
    const std::filesystem::path file = write_report(
        experiments, folder_->path() / "new" / "out",
        [](double fraction, const std::string&) { progress_.push_back(fraction); }, kNoPictures);
    EXPECT_EQ(file, folder_->path() / "new" / "out" / "report.html");
    html_ = read(file);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::filesystem::path out() { return folder_->path() / "new" / "out"; }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline std::string html_;
  static inline std::vector<double> progress_;
};

TEST_F(Report, HasEverySection) {
  for (const char* section : {"Beside the paper", "Details", "Checks", "Force and depth over time",
                              "Touch noise", "Timing", "What was run"}) {
    EXPECT_THAT(html_, HasSubstr(section));
  }
  EXPECT_THAT(html_, HasSubstr("id=\"experiment-1\""));
  EXPECT_THAT(html_, HasSubstr("id=\"experiment-2\""));
}

TEST(ReportOfAMovingOrgan, SaysTheMotionAndPlotsTheOrgansWayBesideTheDepth) {
  const TemporaryFolder folder;
  record::Recording recording = SyntheticRecording::make(false, 1200);
  recording.scene.organ_motion = {model::organ_motion_preset(model::OrganMotionKind::kHeartbeat)};
  const std::filesystem::path file =
      write_report({{"A box that beats", &recording, "palpate run"}}, folder.path(), {}, kNoPictures);
  const std::string html = read(file);
  // height(1.199 s) = 10 mm - 22 mm 1.199 / 1.5 = -7.585 mm
  EXPECT_THAT(html, HasSubstr("<h1>A box that beats</h1>\n<p>7.6 mm deep with up to "));
  EXPECT_THAT(html,
              HasSubstr("heartbeat, 3 mm along (0.00, 0.00, 1.00), 4.0° about (0.00, 0.00, 1.00), every "
                        "0.857 s"));
  EXPECT_THAT(html, HasSubstr("displacement of the organ&#39;s centre"));
  const std::string figure = read(folder.path() / "1-over-time.svg");
  EXPECT_THAT(figure, HasSubstr("organ (mm)"));
  EXPECT_THAT(figure, HasSubstr("turned (°, right)"));
}

TEST_F(Report, SaysNothingOfMotionWhereTheOrganLiesStill) {
  EXPECT_THAT(html_, Not(HasSubstr("organ&#39;s motion")));
  EXPECT_THAT(read(out() / "1-over-time.svg"), Not(HasSubstr("organ (mm)")));
}

TEST_F(Report, BeginsWithOneSentenceOfAllExperiments) {
  EXPECT_THAT(html_, HasSubstr("<p>A box pressed &amp; held to 12.0 mm with up to "));
  EXPECT_THAT(html_, HasSubstr(", and a box touched to "));
}

TEST_F(Report, FoldsStatisticsSettingsAndTimings) {
  const std::size_t first = html_.find("<details>");
  for (const char* folded : {"Kolmogorov", "p99.9", "What was run", "Stiffness k"})
    EXPECT_GT(html_.find(folded), first) << folded;
  EXPECT_EQ(count(html_, "<details>"), count(html_, "</details>"));
}

TEST_F(Report, RoundsNumbersToSixDigits) {
  // The layers' limits add up to 8 mm (1 - 0.7^6) / 0.3 = 23.52936 mm.
  EXPECT_THAT(html_, HasSubstr("largest 23.5294 mm"));
  EXPECT_THAT(html_, Not(HasSubstr("23.52936")));
}

TEST_F(Report, NeedsNothingFromOutside) {
  EXPECT_FALSE(std::regex_search(html_, std::regex(R"re((src|href)="(?!data:|#))re")));
  EXPECT_THAT(html_, Not(HasSubstr("<script")));
  EXPECT_THAT(html_, Not(HasSubstr("url(")));
  EXPECT_THAT(html_, Not(HasSubstr("@import")));
  EXPECT_THAT(html_, Not(HasSubstr("<link")));
}

TEST_F(Report, EscapesWhatTheUserNamed) {
  EXPECT_THAT(html_, HasSubstr("A box pressed &amp; held"));
  EXPECT_THAT(html_, HasSubstr("palpate run --seed &lt;1&gt;"));
  EXPECT_THAT(html_, HasSubstr("box &lt;60 x 60&gt;"));
  EXPECT_THAT(html_, HasSubstr("a remark with &lt;angle&gt; &amp; ampersand"));
  EXPECT_THAT(html_, HasSubstr("Meshes: what was repaired"));
  EXPECT_THAT(html_, HasSubstr("liver &lt;1&gt;.stl: turned 12 triangles outwards"));
}

TEST_F(Report, TellsTissueSeedRateAndMachine) {
  for (const char* fact : {"18 N/m", "1.6", "<td>14 mm</td>", "<td>22 mm</td>", "<td>6 mm</td>", "1000 Hz",
                           "a machine", "a compiler", "2011-07-01 12:00:00 UTC", "4,000 ticks, 4.000 s"}) {
    EXPECT_THAT(html_, HasSubstr(fact));
  }
}

TEST_F(Report, TellsDepthAndMissedDeadlines) {
  EXPECT_THAT(html_, HasSubstr("Pressed to 12.00 mm"));
  EXPECT_THAT(html_, HasSubstr("<strong>3</strong> of 4,000 ticks"));
  EXPECT_THAT(html_, HasSubstr("p99.9"));
}

TEST_F(Report, PutsThePapersFiguresBeside) {
  EXPECT_THAT(html_, HasSubstr("1,057 vertices, 2,110 triangles"));
  EXPECT_THAT(html_, HasSubstr("32 ms"));
  EXPECT_THAT(html_, HasSubstr("under 1 ms"));
  EXPECT_THAT(html_, HasSubstr("0.18 N/cm"));
}

TEST_F(Report, LeavesEveryFigureAsAFileAndInThePage) {
  std::size_t drawn = 0;
  for (const char* name : {"1-over-time.svg", "1-law.svg", "1-profile.svg", "1-noise-spectrum.svg",
                           "1-noise-histogram.svg", "1-tick-time.svg", "1-lateness.svg", "2-over-time.svg",
                           "2-law.svg", "2-profile.svg", "2-tick-time.svg", "2-lateness.svg"}) {
    EXPECT_THAT(read(out() / name), HasSubstr("<svg")) << name;
    ++drawn;
  }
  EXPECT_EQ(count(html_, "data:image/svg+xml;base64,"), drawn);
}

TEST_F(Report, SaysWhyAFigureIsMissing) {
  EXPECT_FALSE(std::filesystem::exists(out() / "2-noise-histogram.svg"));
  EXPECT_EQ(count(html_, "The noise was off."), 2U);
}

TEST_F(Report, SaysWhyThereAreNoPictures) {
  EXPECT_EQ(count(html_, "There are no pictures of organ and tool: they were not asked for"), 1U);
  EXPECT_EQ(count(html_, "data:image/png;base64,"), 0U);
}

TEST_F(Report, ItsProgressRisesToOne) {
  ASSERT_FALSE(progress_.empty());
  EXPECT_TRUE(std::is_sorted(progress_.begin(), progress_.end()));
  EXPECT_DOUBLE_EQ(progress_.back(), 1.0);
}

/// One report with rendered pictures.
class ReportPictures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const record::Recording recording = SyntheticRecording::make(true, 1600);
    html_ = read(write_report({{"t", &recording, "c"}}, folder_.emplace().path(), {}, {true, 160, 120}));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static inline std::optional<TemporaryFolder> folder_;
  static inline std::string html_;
};

TEST_F(ReportPictures, AreInThePageAndAsFilesOrItSaysWhyNot) {
  const std::size_t pictures = count(html_, "data:image/png;base64,");
  EXPECT_EQ(pictures + 8 * count(html_, "There are no pictures of organ and tool"), 8U);
  if (pictures > 0) {
    for (const char* name : {"1-before", "2-contact", "3-depth", "4-after"}) {
      const std::string file = std::string("1-picture-") + name;
      EXPECT_THAT(read(*folder_ / (file + ".png")), HasSubstr("PNG")) << file;
      EXPECT_THAT(read(*folder_ / (file + "-close.png")), HasSubstr("PNG")) << file;
    }
    EXPECT_NE(read(*folder_ / "1-picture-1-before-close.png"),
              read(*folder_ / "1-picture-3-depth-close.png"));
  }
}

TEST_F(ReportPictures, InMotionAreComparedWithThePapersFrameTime) {
  const std::regex row("<td>32 ms</td><td>([0-9.]+ ms p50, [0-9.]+ ms p99 \\(in motion, balanced|not drawn)");
  EXPECT_TRUE(std::regex_search(html_, row));
}

/// The report of a run with this many late ticks out of 4000.
std::string report_of_late_ticks(std::uint64_t missed) {
  const TemporaryFolder folder;
  record::Recording recording = SyntheticRecording::make(false, 4000);
  recording.facts.missed_deadlines = missed;
  return read(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures));
}

TEST(ReportOfLateTicks, ExplainsFewAndMarksThemAmber) {
  const std::string html = report_of_late_ticks(4);  // 0.1 %, the largest usual share
  EXPECT_THAT(html, HasSubstr("class=\"mark late\""));
  EXPECT_THAT(html,
              HasSubstr("4 of 4,000 ticks began a full period or more late (0.10 %). Up to 0.1 % is usual"));
  EXPECT_THAT(html, HasSubstr("palpate doctor"));
  EXPECT_THAT(html, Not(HasSubstr("class=\"mark missed\"")));
}

TEST(ReportOfLateTicks, MarksMoreThanTheUsualShareAsMissed) {
  const std::string html = report_of_late_ticks(5);
  EXPECT_THAT(html, HasSubstr("class=\"mark missed\""));
  EXPECT_THAT(html, HasSubstr("palpate doctor"));
}

TEST(ReportFolder, LosesTheFiguresOfAnEarlierReportAndNothingElse) {
  const TemporaryFolder folder;
  const record::Recording recording = SyntheticRecording::make(false, 300);
  const Experiment one{"t", &recording, "c"};
  static_cast<void>(write_report({one, one}, folder.path(), {}, kNoPictures));
  const auto exists = [&folder](const char* name) { return std::filesystem::exists(folder.path() / name); };
  ASSERT_TRUE(exists("2-law.svg"));
  ASSERT_TRUE(exists("2-over-time.svg"));
  std::ofstream(folder.path() / "2-over-time.svg") << "changed by its owner";
  std::ofstream(folder.path() / "2-mine.svg") << "of a stranger";
  std::filesystem::rename(folder.path() / "2-tick-time.svg", folder.path() / "kept");
  std::filesystem::create_symlink("kept", folder.path() / "2-tick-time.svg");
  static_cast<void>(write_report({one}, folder.path(), {}, kNoPictures));
  EXPECT_FALSE(exists("2-law.svg"));
  EXPECT_TRUE(exists("1-law.svg"));
  EXPECT_TRUE(exists("2-over-time.svg"));
  EXPECT_TRUE(exists("2-mine.svg"));
  EXPECT_TRUE(exists("2-tick-time.svg"));
  EXPECT_TRUE(exists("kept"));
}

TEST(ReportFolder, WithASlashAtItsEndIsTheSameFolder) {
  const TemporaryFolder folder;
  const record::Recording recording = SyntheticRecording::make(false, 300);
  const Experiment one{"t", &recording, "c"};
  static_cast<void>(write_report({one, one}, folder.path(), {}, kNoPictures));
  static_cast<void>(write_report({one}, folder.path() / "", {}, kNoPictures));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "1-law.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "2-law.svg"));
}

TEST(ReportFolder, DeletesNothingOutsideItWhateverItsListSays) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "out");
  std::ofstream(folder.path() / "other.svg") << "";
  std::ofstream(folder.path() / "out" / "notes.txt") << "";
  // SHA-256 of no bytes [FIPS 180-4]
  const std::string empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
  std::ofstream(folder.path() / "out" / "report-figures.sha256") << empty << "  ../other.svg\n"
                                                                 << empty << "  notes.txt\nshort\n";
  const record::Recording recording = SyntheticRecording::make(false, 300);
  static_cast<void>(write_report({{"t", &recording, "c"}}, folder.path() / "out", {}, kNoPictures));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "other.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "notes.txt"));
}

TEST(ReportFolder, LinksInPlaceOfFiguresAndListAreReplacedByFiles) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  std::ofstream(folder.path() / "theirs") << "precious";
  for (const char* name : {"1-law.svg", "report-figures.sha256"})
    std::filesystem::create_symlink("../theirs", out / name);
  const record::Recording recording = SyntheticRecording::make(false, 300);
  static_cast<void>(write_report({{"t", &recording, "c"}}, out, {}, kNoPictures));
  EXPECT_EQ(read(folder.path() / "theirs"), "precious");
  for (const char* name : {"1-law.svg", "report-figures.sha256"})
    EXPECT_FALSE(std::filesystem::is_symlink(out / name)) << name;
  EXPECT_THAT(read(out / "report-figures.sha256"), HasSubstr("  1-law.svg\n"));
  EXPECT_THAT(read(out / "1-law.svg"), HasSubstr("<svg"));
}

TEST(ReportFolder, AListThatIsNotOursCountsAsNone) {
  const TemporaryFolder folder;
  const std::filesystem::path list = folder.path() / "report-figures.sha256";
  std::ofstream(list) << std::string(std::size_t{2} << 20U, 'x');  // larger than a list may be
  const record::Recording recording = SyntheticRecording::make(false, 300);
  static_cast<void>(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures));
  EXPECT_EQ(read(list).find('x'), std::string::npos);
  EXPECT_THAT(read(list), HasSubstr("  1-law.svg\n"));
}

TEST(ReportFolder, FileNamesOfAReportAreKnown) {
  for (const char* name : {"1-law.svg", "12-hand-2-profile.svg", "1-picture-1-before.png", "report.html",
                           "report-figures.sha256"}) {
    EXPECT_TRUE(is_report_file(name)) << name;
  }
  for (const char* name : {"law.svg", "1-law.csv", "-law.svg", "1law.png", "recording.h5", "a1-law.svg", ""})
    EXPECT_FALSE(is_report_file(name)) << name;
}

TEST(ReportFolder, ThatCannotBeMadeIsRefused) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "in the way";
  const record::Recording recording = SyntheticRecording::make(true, 100);
  EXPECT_THROW(
      static_cast<void>(write_report({{"t", &recording, "c"}}, folder.path() / "file", {}, kNoPictures)),
      InputError);
}

TEST(ReportOffline, HasNoDeadlines) {
  const TemporaryFolder folder;
  record::Recording recording = SyntheticRecording::make(true, 300);
  recording.facts.offline = true;
  for (haptics::TickRow& row : recording.rows) row.tick_ns = row.late_ns = 0;
  const std::string html = read(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures));
  EXPECT_THAT(html, HasSubstr("there are no deadlines to miss"));
  EXPECT_THAT(html, Not(HasSubstr("Missed deadlines")));
  EXPECT_THAT(html, Not(HasSubstr("A tick took")));
  EXPECT_THAT(html, HasSubstr("not recorded: the run was offline"));
}

TEST(ReportOffline, ShowsHowLongTicksTookWhenTheLoopCountedIt) {
  const TemporaryFolder folder;
  record::Recording recording = SyntheticRecording::make(true, 300);
  recording.facts.offline = true;
  for (haptics::TickRow& row : recording.rows) row.tick_ns = row.late_ns = 0;
  recording.facts.tick_histogram = {{4096, 299}, {90'000, 1}};
  recording.facts.tick_time = {4096, 4096, 90'000, 90'000};
  const std::string html = read(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures));
  EXPECT_THAT(html, HasSubstr("A tick took 4.1 µs (p50)"));
}

TEST(ReportOfAFault, SaysWhichTickAndWhyAndWhatTheWatchdogDid) {
  const TemporaryFolder folder;
  record::Recording recording = SyntheticRecording::make(true, 300);
  for (std::size_t i = 200; i < 300; ++i) {
    recording.rows[i].fault = static_cast<std::uint32_t>(haptics::Fault::kStalled);
  }
  recording.facts.watchdog_stops = 2;
  recording.facts.remarks = {"the watchdog stopped the devices 2 times"};
  const std::string html = read(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures));
  EXPECT_THAT(html, HasSubstr("Hand 0: fault at tick 200 (0.200 s): the loop stood still for 20 ms"));
  EXPECT_THAT(html, HasSubstr("The watchdog stopped the devices"));
  EXPECT_THAT(html, HasSubstr("the watchdog stopped the devices 2 times"));
}

TEST(ReportWithoutTicks, IsRefused) {
  const TemporaryFolder folder;
  const record::Recording recording;
  EXPECT_THROW(static_cast<void>(write_report({{"t", &recording, "c"}}, folder.path(), {}, kNoPictures)),
               InputError);
}

}  // namespace
}  // namespace palpate::report
