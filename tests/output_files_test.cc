// Outputs that equal inputs, or that exist and are not regular files.
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/refused_outputs.h"

namespace palpate::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr dev_t kFullDevice = (1 << 8) | 7;  // device number of /dev/full on Linux
const std::string kShortScene =
    "[organ]\nmesh = \"gallbladder\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:3\"\n";

void record_short(const Folder& folder, const std::string& name) {
  const Outcome made = run(folder, {"run", "--offline", "--duration-s", "0.05", "--record", name});
  ASSERT_EQ(made.exit_code, 0) << made.err;
}

TEST(OutputFiles, AnExportOntoItsRecordingOrALinkToItIsRefused) {
  const Folder folder;
  record_short(folder, "a.h5");
  fs::create_hard_link(folder / "a.h5", folder / "hard.csv");
  fs::create_symlink("a.h5", folder / "soft.csv");
  for (const std::string csv : {"a.h5", "hard.csv", "soft.csv", "./a.h5"}) {
    expect_refused_untouched(folder, {"export", "a.h5", "--csv", csv}, "a.h5", "--csv " + csv,
                             "the recording a.h5");
  }
  expect_refused_untouched(folder, {"view", "a.h5", "--screenshot", "a.h5"}, "a.h5", "--screenshot a.h5",
                           "the recording a.h5");
}

TEST(OutputFiles, ARecordingOntoItsSceneMeshPathOrReplayedRecordingIsRefused) {
  const Folder folder;
  record_short(folder, "a.h5");
  std::ofstream(folder / "s.toml") << kShortScene;
  std::ofstream(folder / "t.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0.1\n0.01,0,0,0.1\n";
  const auto refused = [&folder](const std::string& file, std::vector<std::string> words,
                                 const std::string& other) {
    words.insert(words.begin(), {"run", "--offline"});
    words.insert(words.end(), {"--record", file});
    expect_refused_untouched(folder, words, file, "--record " + file, other);
  };
  refused("s.toml", {"s.toml"}, "the scene s.toml");
  refused("t.csv", {"--device", "scripted:t.csv"}, "--device t.csv");
  refused("a.h5", {"--device", "replay:a.h5"}, "--device a.h5");
  std::ofstream(folder / "r.toml") << kShortScene << "[device]\nkind = \"replay\"\npath = \"a.h5\"\n";
  refused("a.h5", {"r.toml"}, "r.toml:");
}

TEST(OutputFiles, ARecordingOntoABufferOfAGltfMeshIsRefused) {
  const Folder folder;
  const std::array<float, 9> triangle = {0, 0, 0, 0.01F, 0, 0, 0, 0.01F, 0};
  std::ofstream(folder / "a.bin", std::ios::binary).write(reinterpret_cast<const char*>(triangle.data()), 36);
  std::ofstream(folder / "a.gltf")
      << R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})";
  expect_refused_untouched(folder,
                           {"run", "--offline", "--tool", "a.gltf", "--tool-unit", "m", "--record", "a.bin"},
                           "a.bin", "--record a.bin", "a buffer of --tool");
}

TEST(OutputFiles, ARecordingToADeviceOrAFifoIsRefusedAndTheyStay) {
  const Folder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "null");
  for (const std::string file : {"fifo", "null"}) {
    const Outcome outcome = run(folder, {"run", "--offline", "--duration-s", "0.05", "--record", file});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--record " + file), HasSubstr("must be a regular file")));
  }
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(folder.names(), UnorderedElementsAre("fifo", "null"));
}

TEST(OutputFiles, ARecordingThroughALinkChangesTheFileThatItLeadsTo) {
  const Folder folder;
  const Folder elsewhere;
  fs::create_symlink(elsewhere / "new.h5", folder / "a.h5");
  record_short(folder, "a.h5");
  EXPECT_TRUE(fs::is_symlink(folder / "a.h5"));
  EXPECT_EQ(elsewhere.names(), std::vector<std::string>{"new.h5"});
  EXPECT_EQ(run(folder, {"replay", "a.h5", "--verify"}).exit_code, 0);
}

TEST(OutputFiles, TextAndPicturesGoStraightToADevice) {
  const Folder folder;
  record_short(folder, "a.h5");
  const Outcome text = run(folder, {"export", "a.h5", "--csv", "/dev/stdout"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_EQ(text.out.rfind("tick,", 0), 0U);
  EXPECT_EQ(lines(text.out), 51U);
  EXPECT_EQ(run(folder, {"export", "a.h5", "--csv", "/dev/null"}).exit_code, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFiles, APictureThatADeviceDoesNotTakeLeavesTheDevice) {
  const Folder folder;
  record_short(folder, "a.h5");
  // A device file of our own, if the user may make one, because the test could damage /dev/full.
  const std::string full = folder / "full.png";
  if (mknod(full.c_str(), S_IFCHR | 0600, kFullDevice) != 0) return;  // only root can make one
  const Outcome outcome = run(folder, {"view", "a.h5", "--screenshot", "full.png", "--size", "64x48"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(fs::is_character_file(full));
}

TEST(OutputFiles, NoTemporaryFileHasANameThatOthersCanForesee) {
  for (const std::vector<std::string>& output :
       {std::vector<std::string>{"--record", "r.h5"}, {"--screenshot", "a.png"}}) {
    const Folder folder;
    const Folder temporary;
    std::ofstream(folder / "theirs") << "precious";
    std::vector<std::string> words = {"run", "--offline", "--duration-s", "0.05"};
    words.insert(words.end(), output.begin(), output.end());
    Program program(folder.path(), words, {{"TMPDIR", temporary.path().string()}});
    // Temporary names of earlier versions, created while this program still loads its scene.
    const std::string id = std::to_string(program.id());
    fs::create_symlink(folder / "theirs", temporary / ("palpate-" + id + ".h5"));
    fs::create_symlink(folder / "theirs", temporary / (".palpate-" + id + ".h5." + id + ".partial"));
    fs::create_symlink(folder / "theirs", folder / (".r.h5." + id + ".partial"));
    EXPECT_EQ(program.wait().exit_code, 0);
    EXPECT_EQ(text_of(folder / "theirs"), "precious");
    EXPECT_EQ(temporary.names().size(), 2U);
  }
}

/// Limits the size of files of this process and its children, like a full disk for one file.
class FileLimit final {
 public:
  explicit FileLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(OutputFiles, AFullDiskIsReportedWhileTheRunGoesOnAndTheSummaryIsWhole) {
  const Folder folder;
  record_short(folder, "short.h5");
  const FileLimit limit(fs::file_size(folder / "short.h5") + 400'000);
  Program program(folder.path(), {"run", "--headless", "--device", "scripted", "--rate-Hz", "4000",
                                  "--record", "a.h5", "--report", "report", "--json"});
  const std::string reported = "a.h5: the recording ends after its first ";
  while (program.err_so_far().find(reported) == std::string::npos && !program.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(program.ended()) << "the run goes on";
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("the run continues without recording: free disk space, then record again"),
                    HasSubstr("no report and no screenshot were written")));
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_THAT(summary["recording_failure"].get<std::string>(), HasSubstr(reported));
  EXPECT_EQ(summary["recording"], "a.h5");
  EXPECT_EQ(summary["report"], nullptr);
  const Outcome exported = run(folder, {"export", "a.h5", "--csv", "/dev/stdout"});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  const auto rows = std::stoul(outcome.err.substr(outcome.err.find(reported) + reported.size()));
  EXPECT_GE(lines(exported.out), rows + 1) << "all rows that were said to be safe";
  EXPECT_LT(rows, summary["ticks"].get<std::size_t>());
}

TEST(OutputFiles, ARunOfMinutesReportsItsRemarksAtItsStart) {
  const Folder folder;
  std::ofstream(folder / "ms.csv") << "time_s,x_m,y_m,z_m\n0,0,0,0.04\n20000,0,0,0.03\n";
  Program program(folder.path(), {"run", "--headless", "--organ", "box", "--device", "scripted:ms.csv"});
  const auto is_said = [&program] {
    return program.err_so_far().find("is time_s in ms?") != std::string::npos;
  };
  for (int i = 0; i < 3000 && !is_said() && !program.ended(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(is_said());
  EXPECT_FALSE(program.ended()) << "the run goes on";
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("ms.csv: time_s: the rows are 2e+04 s apart"));
}

TEST(OutputFiles, ARunThatIsStoppedByASignalGoesOnWithItsRecordingWhole) {
  const Folder folder;
  Program program(folder.path(), {"run", "--headless", "--record", "a.h5", "--duration-s", "2", "--json"});
  while (!fs::exists(folder / "a.h5") && !program.ended())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.signal(SIGCONT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 0) << "no hand holds a scripted device: " << outcome.err;
  EXPECT_GE(nlohmann::json::parse(outcome.out)["missed_deadlines"], 1);
  EXPECT_EQ(run(folder, {"replay", "a.h5", "--verify"}).exit_code, 0);
}

/// Every command with each flag for an output, without the output's name.
TEST(OutputFiles, AFolderThatIsNotThereOrTakesNoFileIsRefusedByEveryFlagAndNothingIsLeftBehind) {
  const Folder folder;
  record_short(folder, "a.h5");
  const std::vector<std::vector<std::string>> commands = {
      {"run", "--offline", "--duration-s", "0.01", "--record"},
      {"run", "--offline", "--duration-s", "0.01", "--screenshot"},
      {"export", "a.h5", "--csv"},
      {"view", "a.h5", "--screenshot"},
      {"view", "a.h5", "--video"},
      {"run", "--offline", "--duration-s", "0.01", "--report"},
      {"demo", "--report"},
      {"serve", "--wait", "--port", "0", "--record"}};
  expect_unusable_outputs_refused(folder, commands);
}

/// Runs a command line of the program in a shell. Its standard output goes where the command line sends it.
Outcome run_in_shell(const Folder& folder, const std::string& command) {
  const Folder output;
  const std::string all = "cd " + folder.path().string() + " && PALPATE_CACHE=off exec " PALPATE_PROGRAM " " +
                          command + " 2> " + (output / "err");
  const int status = std::system(all.c_str());  // NOLINT(concurrency-mt-unsafe): one thread
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, {}, text_of(output / "err")};
}

TEST(OutputFiles, ResultsThatStandardOutputDoesNotTakeAreAnError) {
  const Folder folder;
  for (const char* command : {"model --tissue liver --direction press --rate-Hz 1000 --force-N 1",
                              "noise --gain-N-m 5e-5 --threshold-mm 5 --contact --samples 10 --seed 1",
                              "--help", "devices", "run --offline --duration-s 0.1 --json"}) {
    EXPECT_EQ(run_in_shell(folder, std::string(command) + " > /dev/null").exit_code, 0) << command;
    const Outcome outcome = run_in_shell(folder, std::string(command) + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_EQ(outcome.err,
              "palpate: standard output: cannot be written: No space left on device; everything else is "
              "done\n")
        << command;
  }
}

TEST(OutputFiles, AnEmptyNameOfAnOutputIsRefusedAndNotTakenForNone) {
  const Folder folder;
  for (const char* flag : {"--record", "--report", "--screenshot"}) {
    const Outcome outcome = run(folder, {"run", "--offline", "--duration-s", "0.1", flag, ""});
    EXPECT_EQ(outcome.exit_code, 2) << flag;
    EXPECT_EQ(outcome.err, std::string("palpate: ") + flag + ": is empty, must have a value\n");
    EXPECT_EQ(run(folder, {"run", "--offline", std::string(flag) + "="}).err, outcome.err);
  }
  EXPECT_EQ(run(folder, {"inspect", ""}).err, "palpate: argument 2: is empty, must have a value\n");
  EXPECT_TRUE(folder.names().empty());
}

TEST(OutputFiles, ANameThatIsNoUtf8IsReplacedInJsonAndItsRecordingIsWritten) {
  const Folder folder;
  const Outcome outcome =
      run(folder, {"run", "--offline", "--duration-s", "0.1", "--json", "--record", "\xFF.h5"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["recording"], "\xEF\xBF\xBD.h5");
  EXPECT_TRUE(fs::exists(folder / "\xFF.h5"));
}

TEST(OutputFiles, InspectDrawsWhatASupportHolds) {
  const Folder folder;
  // The lower third of a box: its bottom, and a third of its four sides.
  const Outcome seen = run(
      folder, {"inspect", "box", "--organ-support", "bed:0,0,-1,0.3", "--json", "--screenshot", "held.png"});
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_THAT(seen.out, HasSubstr("a bed towards (0, 0, -1), 30 % of the extent"));
  std::ifstream picture(folder / "held.png", std::ios::binary);
  std::string start(4, ' ');
  picture.read(start.data(), 4);
  EXPECT_EQ(start, "\x89PNG");
  const Outcome nothing = run(folder, {"inspect", "box", "--screenshot", "a.png"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("needs --organ-support or --reference"));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

const std::string kTetrahedron =
    "OFF\n4 4 0\n0 0 0\n20 0 0\n0 20 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

TEST(OutputFiles, InspectSaysHowFarTheShownSurfaceIsFromAReference) {
  const Folder folder;
  std::ofstream(folder / "a.off") << kTetrahedron;
  const auto with = [&folder](const std::string& rows, std::vector<std::string> more = {}) {
    std::ofstream(folder / "u.csv") << "x_mm,y_mm,z_mm,u_x_mm,u_y_mm,u_z_mm\n" << rows;
    std::vector<std::string> words = {"inspect", "a.off", "--unit", "mm", "--reference", "u.csv"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder, words);
  };
  // The profile moves the pressed vertex (0, 0, 20) alone, by 2 mm along -x; the reference moves it by 1.5
  // mm.
  const std::string rows = "0,0,0,0,0,0\n20,0,0,0,0,0\n0,20,0,0,0,0\n0,0,20.004,-1.5,0,0\n";
  const Outcome seen = with(rows, {"--press=0,0,20,-1,0,0,2,1", "--json", "--screenshot", "e.png"});
  ASSERT_EQ(seen.exit_code, 0) << seen.err;
  const nlohmann::json error = nlohmann::json::parse(seen.out)["surface_error"];
  EXPECT_NEAR(error["rms_mm"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(error["max_mm"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(error["max_at_mm"][2].get<double>(), 20.0, 1e-9);
  EXPECT_TRUE(fs::exists(folder / "e.png"));
  EXPECT_THAT(with(rows).err, HasSubstr("--reference: needs --press"));
  EXPECT_THAT(with(rows.substr(rows.find('\n') + 1), {"--press=0,0,20,-1,0,0,2,1"}).err,
              HasSubstr("u.csv: has no row for the organ's vertex at (0, 0, 0) mm"));
  EXPECT_THAT(with(rows, {"--press=0,0,20,0,0,0,2,1"}).err, HasSubstr("the direction is 0"));
}

TEST(OutputFiles, APictureOfInspectLeavesItsMeshAndIsNamedPng) {
  const Folder folder;
  std::ofstream(folder / "a.off") << kTetrahedron;
  std::vector<std::string> words = {"inspect",         "a.off",      "--unit",       "mm",
                                    "--organ-support", "bed:0,0,-1", "--screenshot", "a.off"};
  expect_refused_untouched(folder, words, "a.off", "--screenshot a.off", "the mesh a.off");
  words.back() = "x.jpg";
  const Outcome outcome = run(folder, words);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--screenshot x.jpg: pictures are PNG files, must end in .png: x.png"));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.off"});
}

TEST(OutputFiles, AFileInTheReportsFolderWithAFiguresNameIsRefused) {
  const Folder folder;
  fs::create_directory(folder / "out");
  for (const char* name : {"1-law.svg", "1-picture-1-before.png", "report-figures.sha256", "report.html"})
    std::ofstream(folder.path() / "out" / name) << "r_mm,u_mm\n0,5\n1,4\n2,3\n3,2\n4,1\n";
  fs::create_symlink("out/1-law.svg", folder / "link.png");
  const auto refused = [&folder](std::vector<std::string> words, const std::string& flag,
                                 const std::string& file) {
    words.insert(words.end(), {"--report", "out", flag, file});
    const std::string before = text_of(folder / file);
    const Outcome outcome = run(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << flag << file << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(flag + " " + file), HasSubstr("another name or folder")));
    EXPECT_TRUE(text_of(folder / file) == before) << file;
  };
  const std::vector<std::string> short_run = {"run", "--offline", "--duration-s", "0.05"};
  refused(short_run, "--record", "out/1-law.svg");
  refused(short_run, "--record", "out/report-figures.sha256");
  refused(short_run, "--screenshot", "out/1-picture-1-before.png");
  refused(short_run, "--screenshot", "link.png");
  refused(short_run, "--profile", "out/1-law.svg");
  refused(short_run, "--profile", "out/report.html");
  refused({"demo"}, "--press-profile", "out/1-law.svg");
  std::ofstream(folder.path() / "out" / "heart.h5") << "r_mm,u_mm\n0,5\n1,4\n2,3\n3,2\n4,1\n";
  expect_refused_untouched(folder, {"demo", "--report", "out", "--pull-profile", "out/heart.h5"},
                           "out/heart.h5", "out/heart.h5", "--pull-profile out/heart.h5");
}

TEST(OutputFiles, AFolderInPlaceOfAReportsListIsRefusedBeforeTheRun) {
  const Folder folder;
  fs::create_directories(folder / "out/report-figures.sha256");
  const Outcome outcome = run(folder, {"run", "--offline", "--duration-s", "0.05", "--report", "out"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("out/report-figures.sha256: is a folder"));
  EXPECT_FALSE(fs::exists(folder / "out/recording.h5"));
}

TEST(OutputFiles, ControlCharactersOfForeignNamesReachNoTerminal) {
  const Folder folder;
  // U+202E and U+2066 would show the letters after them in another order.
  const std::string missing = "\x1B[31m\x9B\xC2\x9B\x07\nred\xC3\xBC\xE2\x80\xAE\xE2\x81\xA6\xE2\x80\x94.stl";
  const Outcome refused = run(folder, {"inspect", missing});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(
      refused.err,
      HasSubstr(
          "\\x1B[31m\\x9B\\xC2\\x9B\\x07\\x0Ared\xC3\xBC\\xE2\\x80\\xAE\\xE2\\x81\\xA6\xE2\x80\x94.stl"));
  EXPECT_EQ(lines(refused.err), 1U);
  std::ofstream(folder / "\x1B[1ma.off") << "OFF\n4 4 0\n0 0 0\n20 0 0\n0 20 0\n0 0 20\n"
                                            "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
  const Outcome seen = run(folder, {"inspect", "\x1B[1ma.off", "--unit", "mm"});
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_THAT(seen.out, HasSubstr("\\x1B[1ma.off\n"));
  EXPECT_EQ(seen.out.find('\x1B'), std::string::npos);
}

}  // namespace
}  // namespace palpate::tests
