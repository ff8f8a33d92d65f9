// What the program says to a mistyped word or a wrong file, and the names that it lists.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/scene/device_kinds.h"
#include "palpate/builtin.h"
#include "palpate/inclusion.h"
#include "palpate/tissue.h"

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// The one line that refuses a command line.
std::string refusal(const Folder& folder, const std::vector<std::string>& words) {
  const Outcome outcome = run(folder, words);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  return outcome.err;
}

TEST(MistypedFlag, GetsTheNearestFlagOfItsCommand) {
  const Folder folder;
  EXPECT_THAT(
      refusal(folder, {"run", "--ofline"}),
      HasSubstr("--ofline: palpate run has no such flag, did you mean --offline? (see palpate run --help)"));
  EXPECT_THAT(refusal(folder, {"run", "--orgn=liver", "--offline"}), HasSubstr("did you mean --organ?"));
  // A flag of an option group, although another one is missing.
  EXPECT_THAT(refusal(folder, {"model", "--dept-mm", "3"}), HasSubstr("did you mean --depth-mm?"));
  EXPECT_THAT(refusal(folder, {"run", "--qwertyuiop"}), Not(HasSubstr("did you mean")));
}

TEST(HelpCommand, ShowsTheHelpOfACommand) {
  const Folder folder;
  EXPECT_EQ(run(folder, {"help", "run"}).out, run(folder, {"run", "--help"}).out);
  EXPECT_EQ(run(folder, {"help"}).out, run(folder, {"--help"}).out);
}

TEST(HelpCommand, RefusesAnUnknownCommand) {
  const Folder folder;
  EXPECT_THAT(refusal(folder, {"help", "inspct"}),
              HasSubstr("inspct: no such command, did you mean inspect?"));
  EXPECT_THAT(refusal(folder, {"inspct", "--help"}), HasSubstr("did you mean inspect?"));
}

std::vector<std::string> names_in(const json& entries) {
  std::vector<std::string> names;
  for (const json& entry : entries) {
    EXPECT_FALSE(entry["description"].get<std::string>().empty()) << entry;
    names.push_back(entry["name"]);
  }
  return names;
}

TEST(ListCommand, HasEveryBuiltInNameWithALineAboutIt) {
  const Folder folder;
  const json all = json::parse(run(folder, {"list", "--json"}).out);
  EXPECT_EQ(names_in(all["organs"]), geometry::builtin_organ_names());
  std::vector<std::string> tools = geometry::builtin_tool_names();
  tools.emplace_back("sphere:R");
  EXPECT_EQ(names_in(all["tools"]), tools);
  const auto tissues = model::tissue_preset_names();
  EXPECT_EQ(names_in(all["tissues"]), std::vector<std::string>(tissues.begin(), tissues.end()));
  std::vector<std::string> devices;
  for (const scene::DeviceKind& kind : scene::device_kinds())
    if (kind.name != "host") devices.emplace_back(kind.name);
  EXPECT_EQ(names_in(all["devices"]), devices);
  std::vector<std::string> inclusions;
  for (const model::InclusionPreset& preset : model::inclusion_presets())
    inclusions.emplace_back(preset.name);
  EXPECT_EQ(names_in(all["inclusions"]), inclusions);
  EXPECT_EQ(names_in(all["tasks"]), (std::vector<std::string>{"press", "pull", "palpate", "insert"}));
  EXPECT_EQ(names_in(all["scenes"]).size(), 4U);
}

TEST(ListCommand, ListsOneKindOrRefusesItsName) {
  const Folder folder;
  const Outcome tissues = run(folder, {"list", "tissues"});
  EXPECT_THAT(tissues.out, HasSubstr("\n  kidney "));
  EXPECT_THAT(tissues.out, Not(HasSubstr("curved-forceps")));
  EXPECT_THAT(refusal(folder, {"list", "tissue"}), HasSubstr("did you mean tissues?"));
}

TEST(WrongFile, IsNamedWithTheCommandThatTakesIt) {
  const Folder folder;
  ASSERT_EQ(run(folder, {"run", "--offline", "--duration-s", "0.05", "--record", "press.h5"}).exit_code, 0);
  EXPECT_THAT(refusal(folder, {"run", "press.h5"}),
              HasSubstr("press.h5: is a recording (HDF5), must be a scene; palpate view press.h5 shows it"));
  std::ofstream(folder / "kidney.stl") << "solid kidney\nfacet normal 0 0 1\n";
  EXPECT_THAT(
      refusal(folder, {"run", "kidney.stl"}),
      HasSubstr("is a mesh (text STL), must be a scene; palpate run --organ kidney.stl --organ-unit mm"));
  EXPECT_THAT(refusal(folder, {"view", "kidney.stl"}), HasSubstr("kidney.stl: is a mesh"));
  EXPECT_THAT(refusal(folder, {"run", "liver"}), HasSubstr("palpate run --organ liver"));
  EXPECT_THAT(refusal(folder, {"score", "press.h5"}),
              HasSubstr("press.h5: no search in it: its task is press"));
}

TEST(Screenshot, RefusesANameOfAnotherFormatBeforeTheRun) {
  const Folder folder;
  EXPECT_THAT(refusal(folder, {"run", "--offline", "--record", "a.h5", "--screenshot", "x.JPG"}),
              HasSubstr("--screenshot x.JPG: pictures are PNG files, must end in .png: x.png"));
  EXPECT_TRUE(folder.names().empty());
}

TEST(Tables, HaveSixDigitsAndJsonHasAll) {
  const Folder folder;
  const std::vector<std::string> words = {"model", "--tissue", "liver", "--depth-mm", "5"};
  EXPECT_THAT(run(folder, words).out, HasSubstr(" 0.0904823 "));
  std::vector<std::string> as_json = words;
  as_json.emplace_back("--json");
  const double force = json::parse(run(folder, as_json).out)["results"][0]["force_N"];
  EXPECT_NEAR(force, 0.0904823, 5e-8);
  EXPECT_NE(force, 0.0904823);
  EXPECT_THAT(run(folder, {"inspect", "ball"}).out, HasSubstr(" mm^3\n"));
  EXPECT_THAT(run(folder, {"inspect", "ball"}).out, Not(::testing::ContainsRegex("[0-9]\\.[0-9]{6}")));
}

TEST(InspectCommand, SaysThatAnOrganLiesWhereNoDeviceReaches) {
  const Folder folder;
  std::ofstream(folder / "far.obj") << "v 1e7 0 0\nv 10000060 0 0\nv 1e7 60 0\nv 1e7 0 60\n"
                                       "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const json shown = json::parse(run(folder, {"inspect", "far.obj", "--unit", "mm", "--json"}).out);
  EXPECT_FALSE(shown["organ"].get<bool>());
  EXPECT_THAT(shown["refused_as_organ"].get<std::string>(),
              HasSubstr("the organ lies 1e+04 m from the origin"));
}

TEST(Report, SaysWhatItIsDoingWhereThereIsNoTerminal) {
  const Folder folder;
  const Outcome outcome =
      run(folder, {"run", "--offline", "--duration-s", "0.05", "--report", "out"}, kNoPictures);
  EXPECT_THAT(outcome.err,
              HasSubstr("report: 0 % Gallbladder pressed with curved forceps: replaying the run\n"));
  EXPECT_THAT(outcome.err, HasSubstr(": pictures of organ and tool\n"));
  EXPECT_THAT(outcome.err, HasSubstr("report: 100 % report\n"));
}

}  // namespace
}  // namespace palpate::tests
