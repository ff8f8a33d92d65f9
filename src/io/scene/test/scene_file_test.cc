#include "io/scene/scene_file.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "io/scene/toml_reader.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

const double kScenePi = std::acos(-1.0);

const std::string kShort =
    "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"curved-forceps\"\n";  // four lines

SceneFile described(const std::string& content) {
  const TemporaryFolder folder;
  return read_scene_file(folder.write("press.toml", content));
}

std::string scene_error_in(const std::string& content) {
  const TemporaryFolder folder;
  const auto file = folder.write("press.toml", content);
  const std::string message = error_of([&] { (void)read_scene_file(file); });
  EXPECT_TRUE(message.starts_with(file.string() + ":")) << message;
  return message.starts_with(folder.path().string()) ? message.substr(folder.path().string().size() + 1)
                                                     : message;
}

TEST(SceneFile, ReadsEveryFieldIntoSi) {
  const SceneFile scene = described(R"(
[scene]
name = "a pull"
task = "pull"
rate_Hz = 4000
seed = 7
[organ]
mesh = "organ.stl"
unit = "cm"
tissue = "soft.toml"
pose = { position_mm = [1, -2.5, 3], rotation_deg = [0, 0, 90] }
[tool]
mesh = "shaft.stl"
unit = "mm"
mount = { position_mm = [0, 0, 10] }
tip_radius_mm = 3.0
[[tool.jaw]]
mesh = "left.stl"
pivot_mm = [1, 2, 3]
axis = [0, 0, 2]
open_deg = -20
[[tool.jaw]]
mesh = "right.stl"
[device]
kind = "scripted"
path = "way.csv"
interpolation = "cubic"
workspace_scale = 2.0
base = { position_mm = [100, 0, 0], rotation_deg = [90, 0, 0] }
[noise]
enabled = false
gain_N_m = 1e-4
threshold_mm = 4.0
rate_Hz = 500
[safety]
max_force_N = 10.0
max_slew_N_per_ms = 2.0
max_torque_N_m = 0.1
max_slew_N_m_per_ms = 0.02
)");
  EXPECT_EQ(scene.name, "a pull");
  EXPECT_EQ(scene.task, Task::kPull);
  EXPECT_EQ(scene.rate_Hz, 4000.0);
  EXPECT_EQ(scene.seed, 7U);
  EXPECT_EQ(scene.organ->value, "organ.stl");
  EXPECT_EQ(scene.organ->file(), scene.organ->folder / "organ.stl");
  EXPECT_EQ(scene.organ_unit, LengthUnit::kCentimetre);
  EXPECT_EQ(scene.tissue->value, "soft.toml");
  EXPECT_NEAR((scene.organ_pose * Vec3(1.0, 0.0, 0.0) - Vec3(0.001, 0.9975, 0.003)).norm(), 0.0, 1e-15);
  ASSERT_EQ(scene.tools.size(), 1U);
  const ToolTable& tool = scene.tools[0];
  EXPECT_EQ(tool.mesh->value, "shaft.stl");
  EXPECT_EQ(tool.unit, LengthUnit::kMillimetre);
  EXPECT_DOUBLE_EQ(tool.mount.position.z(), 0.010);
  EXPECT_DOUBLE_EQ(*tool.tip_radius, 0.003);
  ASSERT_EQ(tool.jaws.size(), 2U);
  EXPECT_EQ(tool.jaws[0].axis, Vec3(0.0, 0.0, 1.0));
  EXPECT_DOUBLE_EQ(tool.jaws[0].pivot.y(), 0.002);
  EXPECT_DOUBLE_EQ(tool.jaws[0].open_angle, -kScenePi / 9.0);
  EXPECT_EQ(tool.jaws[1].axis, Vec3(0.0, 1.0, 0.0));
  EXPECT_EQ(tool.jaws[1].pivot, Vec3(0.0, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(tool.jaws[1].open_angle, kScenePi / 12.0);
  EXPECT_FALSE(tool.jaws_by_flags);
  ASSERT_EQ(scene.devices.size(), 1U);
  EXPECT_EQ(scene.devices[0].kind.value, "scripted");
  EXPECT_EQ(scene.devices[0].path->value, "way.csv");
  EXPECT_EQ(scene.devices[0].interpolation, PathInterpolation::kCubic);
  EXPECT_EQ(scene.devices[0].setup.workspace_scale, 2.0);
  EXPECT_NEAR((scene.devices[0].setup.base * Vec3(0.0, 1.0, 0.0) - Vec3(0.1, 0.0, 1.0)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(scene.noise.enabled);
  EXPECT_EQ(scene.noise.gain, 1e-4);
  EXPECT_DOUBLE_EQ(scene.noise.threshold, 0.004);
  EXPECT_EQ(scene.noise.rate_Hz, 500.0);
  EXPECT_EQ(scene.safety.max_force, 10.0);
  EXPECT_EQ(scene.safety.max_slew, 2000.0);
  EXPECT_EQ(scene.safety.max_torque, 0.1);
  EXPECT_DOUBLE_EQ(scene.safety.max_torque_slew, 20.0);
}

TEST(SceneFile, DefaultsAllThatIsNotRequired) {
  const SceneFile scene = described(kShort);
  EXPECT_EQ(scene.name, "press");
  EXPECT_EQ(scene.task, Task::kPress);
  EXPECT_EQ(scene.rate_Hz, 1000.0);
  EXPECT_EQ(scene.seed, 1U);
  EXPECT_FALSE(scene.tissue.has_value());
  EXPECT_EQ(scene.organ_pose.position, Vec3(0.0, 0.0, 0.0));
  EXPECT_TRUE(scene.devices.empty());
  EXPECT_TRUE(scene.noise.enabled);
  EXPECT_EQ(scene.noise.gain, 5e-5);
  EXPECT_EQ(scene.noise.threshold, 5e-3);
  EXPECT_EQ(scene.noise.rate_Hz, 1000.0);
  EXPECT_EQ(scene.safety.max_force, 20.0);
  EXPECT_EQ(scene.safety.max_slew, 5000.0);
  EXPECT_EQ(scene.safety.max_torque, 0.2);
  EXPECT_EQ(scene.safety.max_torque_slew, 50.0);
}

TEST(SceneFile, TakesToolsAndDevicesAsArraysOfTables) {
  const SceneFile scene = described(R"([organ]
mesh = "heart"
[[tool]]
mesh = "sphere:3"
[[tool]]
[[tool.jaw]]
mesh = "a.stl"
[[device]]
kind = "scripted"
[[device]]
kind = "replay"
path = "old.h5"
)");
  ASSERT_EQ(scene.tools.size(), 2U);
  EXPECT_EQ(scene.tools[0].mesh->value, "sphere:3");
  EXPECT_TRUE(scene.tools[0].jaws.empty());
  EXPECT_FALSE(scene.tools[1].mesh.has_value());
  EXPECT_EQ(scene.tools[1].jaws.size(), 1U);
  ASSERT_EQ(scene.devices.size(), 2U);
  EXPECT_EQ(scene.devices[1].kind.value, "replay");
}

TEST(SceneFile, NoiseLevelMayBeAShareOfTheUsersThreshold) {
  const SceneFile scene =
      described(kShort + "[noise]\nuser_threshold_N = 0.02\nshare_of_threshold = 0.5\nthreshold_mm = 4\n");
  EXPECT_DOUBLE_EQ(scene.noise.gain, 0.5 * 0.02 * 0.004);  // sigma in contact K/d0 = 10 mN
  EXPECT_DOUBLE_EQ(described(kShort + "[noise]\nuser_threshold_N = 0.02\n").noise.gain, 0.6 * 0.02 * 0.005);
}

TEST(SceneFile, NamesTheNearestKnownKeyInEveryTable) {
  EXPECT_EQ(scene_error_in(kShort + "[scene]\nrate_HZ = 1000\n"),
            "press.toml:6: scene.rate_HZ = 1000: unknown key, did you mean rate_Hz?");
  EXPECT_EQ(scene_error_in("[organ]\nmsh = \"heart\"\n"),
            "press.toml:2: organ.msh = \"heart\": unknown key, did you mean mesh?");
  EXPECT_THAT(scene_error_in(kShort + "[organn]\n"), HasSubstr("press.toml:5: organn = "));
  for (const auto& [line, hint] : std::vector<std::pair<std::string, std::string>>{
           {"[organ.pose]\nposition = 3\n",
            "organ.pose.position = 3: unknown key, did you mean position_mm?"},
           {"[tool.mount]\nrotation_mm = 3\n", "tool.mount.rotation_mm = 3: unknown key"},
           {"[[tool.jaw]]\nmesh = \"a.stl\"\nopen = 3\n",
            "tool.jaw.open = 3: unknown key, did you mean open_deg?"},
           {"[device]\nkinds = 3\n", "device.kinds = 3: unknown key, did you mean kind?"},
           {"[noise]\ngain_N = 3\n", "noise.gain_N = 3: unknown key, did you mean gain_N_m?"},
           {"[safety]\nmax_force = 3\n", "safety.max_force = 3: unknown key, did you mean max_force_N?"}}) {
    EXPECT_THAT(scene_error_in(kShort + line), HasSubstr(hint));
  }
}

TEST(SceneFile, NestedSoDeepThatTheTreeWouldTakeTheStackIsRefusedAtItsLine) {
  std::string key;
  for (int i = 0; i < 60'000; ++i) key += "a.";
  const std::string brackets(60'000, '[');
  for (const std::string& content :
       {key + "a = 1", "[" + key + "a]", "[[" + key + "a]]", "a = " + brackets, "a = {" + key + "a = 1}"}) {
    const std::string error = scene_error_in("# a comment\n\n" + content + "\n");
    EXPECT_EQ(
        error,
        "press.toml:3: nested deeper than 64 levels, must be at most that; each part of a dotted key is "
        "a level");
    EXPECT_EQ(error_of([&] { (void)read_scene_text(content, {}); }).substr(0, 43),
              "scene text:1: nested deeper than 64 levels,");
    EXPECT_THROW((void)parse_toml(content, "tissue"), InputError);
  }
}

TEST(SceneFile, ATextLargerThanAFileMayBeIsRefused) {
  const std::string large(1'048'577, '\n');
  EXPECT_EQ(error_of([&] { (void)read_scene_text(large, {}); }),
            "scene text: has 1048577 bytes, must be a TOML text of at most 1048576");
}

TEST(SceneFile, RefusesNamesAndTextsThatAreTooLong) {
  const std::string longest(256, 'n');
  EXPECT_EQ(described("[scene]\nname = \"" + longest + "\"\n" + kShort).name, longest);
  const std::string shown =
      std::string(80, 'n') + "...\": must be a text in quotes, not empty, on one line, ";
  EXPECT_EQ(scene_error_in("[scene]\nname = \"" + longest + "n\"\n" + kShort),
            "press.toml:2: scene.name = \"" + shown + "of at most 256 bytes");
  EXPECT_EQ(scene_error_in(kShort + "[[organ.inclusion]]\nname = \"" + longest + "n\""),
            "press.toml:6: organ.inclusion.name = \"" + shown + "of at most 256 bytes");
  EXPECT_EQ(scene_error_in("[organ]\nmesh = \"" + std::string(4097, 'n') + "\""),
            "press.toml:2: organ.mesh = \"" + shown + "of at most 4096 bytes");
}

TEST(SceneFile, ShortensLongKeysAndValuesInErrors) {
  const std::string word(5000, 'k');
  const std::string shown = word.substr(0, 80) + "...";
  EXPECT_THAT(scene_error_in("[" + word + "]"), HasSubstr(":1: " + shown + " = "));
  EXPECT_THAT(scene_error_in("\"" + word.substr(0, 79) + "\xC3\xBC\" = 1"),
              HasSubstr(":1: " + word.substr(0, 79) + "... = 1: unknown key"))
      << "a character is not cut in two";
  EXPECT_LT(scene_error_in("[" + word + "]\n[" + word + "]").size(), 400U);
  EXPECT_THAT(scene_error_in("[scene]\ntask = \"" + word.substr(0, 4096) + "\""),
              HasSubstr(":2: scene.task = \"" + word.substr(0, 256) +
                        "...\": must be press, pull, palpate or insert"));
}

TEST(SceneFile, RefusesBadValuesAtTheirLineWithFieldAndValue) {
  for (const auto& [line, want] : std::vector<std::pair<std::string, std::string>>{
           {"[scene]\ntask = \"cut\"", ":6: scene.task = \"cut\": must be press, pull, palpate or insert"},
           {"[scene]\ntask = 1", ":6: scene.task = 1: must be a text in quotes"},
           {"[scene]\nrate_Hz = 0", ":6: scene.rate_Hz = 0: must be a number >= 100 and <= 20000"},
           {"[scene]\nrate_Hz = -1000", ":6: scene.rate_Hz = -1000: must be a number >= 100"},
           {"[scene]\nrate_Hz = nan", ":6: scene.rate_Hz = nan: must be a number >= 100"},
           {"[scene]\nrate_Hz = \"fast\"", ":6: scene.rate_Hz = \"fast\": must be a number >= 100"},
           {"[scene]\nrate_Hz = 20001", ":6: scene.rate_Hz = 20001: must be a number"},
           {"[scene]\nseed = -1", ":6: scene.seed = -1: must be a whole number >= 0"},
           {"[scene]\nseed = 1.5", ":6: scene.seed = 1.5: must be a whole number >= 0"},
           {"[organ.pose]\nposition_mm = [0, 0]",
            ":6: organ.pose.position_mm = [ 0, 0 ]: must be three numbers"},
           {"[organ.pose]\nposition_mm = [0, 0, nan]", "must be three numbers"},
           {"[organ.pose]\nrotation_deg = [0, 0, \"a\"]", "must be three numbers"},
           {"[organ.pose]\nrotation_deg = 90", ":6: organ.pose.rotation_deg = 90: must be three numbers"},
           {"[[tool.jaw]]\nopen_deg = 3", ":5: tool.jaw.mesh: missing"},
           {"[[tool.jaw]]\nmesh = \"a.stl\"\naxis = [0, 0, 0]",
            ":7: tool.jaw.axis = [ 0, 0, 0 ]: must be a direction"},
           {"[[tool.jaw]]\nmesh = \"a.stl\"\nopen_deg = inf",
            ":7: tool.jaw.open_deg = inf: must be a number >= -180"},
           {"[tool.needle]\ndiameter_mm = 1.2",
            ":5: tool.needle.length_mm: missing, the length of the shaft"},
           {"[tool.needle]\nlength_mm = 90\ndiameter_mm = 0.0012",
            ":7: tool.needle.diameter_mm = 0.0012: must be a number >= 0.1 and <= 10"},
           {"[tool.needle]\nlength_mm = 90\ndiameter_mm = 1\naxis = [0, 0, 0]",
            ":8: tool.needle.axis = [ 0, 0, 0 ]: must be a direction"},
           {"[device]\nworkspace_scale = 0", ":6: device.workspace_scale = 0: must be a number > 0"},
           {"[device]\ninterpolation = \"spline\"",
            ":6: device.interpolation = \"spline\": must be linear or cubic"},
           {"[device]\nbase = 1", ":6: device.base = 1: must be a table"},
           {"[noise]\nenabled = 1", ":6: noise.enabled = 1: must be true or false"},
           {"[noise]\ngain_N_m = -1e-5", ":6: noise.gain_N_m = -1e-05: must be"},
           {"[noise]\nthreshold_mm = 0", ":6: noise.threshold_mm = 0: must be a finite number > 0"},
           {"[noise]\nrate_Hz = 0", ":6: noise.rate_Hz = 0: must be a number >= 0.001"},
           {"[noise]\nuser_threshold_N = 0", ":6: noise.user_threshold_N = 0: must be"},
           {"[noise]\nuser_threshold_N = 0.02\nshare_of_threshold = 1.2",
            ":7: noise.share_of_threshold = 1.2: must be"},
           {"[noise]\nshare_of_threshold = 0.6",
            ":6: noise.share_of_threshold = 0.6: needs user_threshold_N"},
           {"[noise]\ngain_N_m = 1e-5\nuser_threshold_N = 0.02",
            ":6: noise.gain_N_m = 1e-05: excludes user_threshold_N"},
           {"[safety]\nmax_force_N = 0", ":6: safety.max_force_N = 0: must be a number > 0 and <= 50"},
           {"[safety]\nmax_force_N = 1214", ":6: safety.max_force_N = 1214: must be a number > 0 and <= 50"},
           {"[safety]\nmax_slew_N_per_ms = -1",
            ":6: safety.max_slew_N_per_ms = -1: must be a number > 0 and <= 50"},
           {"[safety]\nmax_torque_N_m = inf",
            ":6: safety.max_torque_N_m = inf: must be a number > 0 and <= 5"},
           {"[safety]\nmax_slew_N_m_per_ms = nan", ":6: safety.max_slew_N_m_per_ms = nan: must be"}}) {
    EXPECT_THAT(scene_error_in(kShort + line + "\n"), HasSubstr(want)) << line;
  }
}

TEST(SceneFile, RefusesBadValuesInOrganAndTool) {
  EXPECT_THAT(scene_error_in("[organ]\nmesh = \"a.stl\"\nunit = \"feet\"\n"),
              HasSubstr(":3: organ.unit = \"feet\": must be mm, cm, m or in"));
  EXPECT_THAT(scene_error_in("[organ]\nmesh = 3\n"), HasSubstr(":2: organ.mesh = 3: must be a text"));
  EXPECT_THAT(scene_error_in("[organ]\nmesh = \"\"\n"), HasSubstr(":2: organ.mesh = \"\": must be a text"));
  EXPECT_THAT(scene_error_in("[tool]\nunit = \"mm\"\n"),
              HasSubstr(":1: tool.mesh: missing, a tool needs a mesh"));
  EXPECT_THAT(scene_error_in("[tool]\nmesh = \"sphere:3\"\ntip_radius_mm = 0\n"),
              HasSubstr(":3: tool.tip_radius_mm = 0: must be a number > 0"));
  EXPECT_THAT(scene_error_in("tool = 3\n"), HasSubstr(":1: tool = 3: must be a table or an array of tables"));
  EXPECT_THAT(scene_error_in("tool = [3]\n"), HasSubstr("must be a table or an array of tables"));
}

}  // namespace
}  // namespace palpate::scene
