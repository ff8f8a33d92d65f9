#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kShortLoaded =
    "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"curved-forceps\"\n";  // four lines

/// A box of 40 mm as an OBJ file.
const std::string kBox =
    "v -20 -20 -20\nv 20 -20 -20\nv 20 20 -20\nv -20 20 -20\nv -20 -20 20\nv 20 -20 20\nv 20 20 20\nv -20 20 "
    "20\n"
    "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 "
    "5 8\n";

Overrides scene_of(const std::filesystem::path& file) {
  Overrides request;
  request.scene = file;
  return request;
}

std::string error_in(const Overrides& request) {
  return error_of([&] { (void)load(request); });
}

TEST(Load, NothingAskedForIsTheGallbladderPress) {
  const scene::Scene scene = load({});
  EXPECT_EQ(scene.name, "gallbladder press");
  EXPECT_EQ(scene.task, Task::kPress);
  EXPECT_EQ(scene.organ_name, "gallbladder");
  EXPECT_EQ(scene.organ.vertices.size(), 1057U);
  EXPECT_EQ(scene.tissue.name, "gallbladder");
  ASSERT_EQ(scene.tools.size(), 1U);
  EXPECT_EQ(scene.tools[0].name, "curved-forceps");
  ASSERT_EQ(scene.devices.size(), 1U);
  EXPECT_EQ(scene.devices[0].kind, "scripted");
  EXPECT_EQ(scene.devices[0].path, "");
  EXPECT_EQ(scene.rate_Hz, 1000.0);
  EXPECT_TRUE(scene.noise.enabled);
}

TEST(Load, TaskPullAloneIsTheHeart) {
  Overrides request;
  request.task = "pull";
  const scene::Scene scene = load(request);
  EXPECT_EQ(scene.name, "heart pull");
  EXPECT_EQ(scene.task, Task::kPull);
  EXPECT_EQ(scene.organ_name, "heart");
  EXPECT_EQ(scene.tissue.name, "heart");
  EXPECT_EQ(scene.tools[0].name, "straight-forceps");
}

TEST(Load, TaskInsertAloneIsANeedleInABlockWithLayers) {
  Overrides request;
  request.task = "insert";
  const scene::Scene scene = load(request);
  EXPECT_EQ(scene.organ_name, "box");
  ASSERT_TRUE(scene.tools.at(0).needle.has_value());
  EXPECT_EQ(scene.tools[0].needle->tip, Vec3(0.0, 0.0, 90e-3));
  EXPECT_EQ(scene.tools[0].needle->diameter, 1.2e-3);
  ASSERT_EQ(scene.tissue.layers.size(), 3U);
  EXPECT_EQ(scene.tissue.layers[0].name, "skin");
  EXPECT_EQ(scene.tissue.layers[0].thickness, 2e-3);
}

TEST(Load, TaskInsertWithoutANeedleOrWithoutLayersIsRefused) {
  Overrides request;
  request.task = "insert";
  request.tools = {"sphere:3"};
  EXPECT_THAT(error_in(request), HasSubstr("tool \"sphere:3\" is no needle, which task insert needs"));
  request.tools = {"needle:14G,50,pencil"};
  request.tissue = "liver";
  EXPECT_THAT(error_in(request), AllOf(HasSubstr("--tissue: tissue 'liver' has no [[tissue.layer]]"),
                                       HasSubstr("skin-fat-muscle, liver-capsule, vein or epidural")));
}

TEST(Load, ANeedleThatPressesATissueWithoutLayersIsNoted) {
  Overrides request;
  request.tools = {"needle"};
  const std::vector<std::string> remarks = load(request).remarks;
  EXPECT_THAT(remarks, testing::Contains(HasSubstr("the needle presses and does not go in")));
}

TEST(Load, ANeedleOfAnUnknownSizeLengthOrTipIsRefusedWithWhatWouldBeRight) {
  Overrides request;
  for (const auto& [name, must] : std::vector<std::pair<std::string, std::string>>{
           {"needle:24G", "must be a diameter of 0.3 to 3.4 mm, or a gauge: 10, 11"},
           {"needle:5", "must be a diameter of 0.3 to 3.4 mm"},
           {"needle:18G,5", "the length \"5\" must be 10 to 300 mm"},
           {"needle:18G,90,sharp", "the tip \"sharp\" must be bevel, pencil or tuohy"},
           {"needle:18G,90,bevel,1", "\"1\" is one part too many"}}) {
    request.tools = {name};
    EXPECT_THAT(error_in(request), HasSubstr(must)) << name;
  }
}

TEST(Load, TissueDefaultsToTheOrgansOwnThenToTheTasks) {
  Overrides request;
  request.organ = "heart";
  EXPECT_EQ(load(request).tissue.name, "heart");
  request.organ = "heart-30k";
  EXPECT_EQ(load(request).tissue.name, "heart");
  request.organ = "liver";
  EXPECT_EQ(load(request).tissue.name, "liver");
  request.organ = "kidney-30k";
  EXPECT_EQ(load(request).tissue.name, "kidney");
  request.organ = "box";
  EXPECT_EQ(load(request).tissue.name, "gallbladder");
  request.task = "pull";
  EXPECT_EQ(load(request).tissue.name, "heart");
  request.tissue = "liver";
  EXPECT_EQ(load(request).tissue.name, "liver");
}

TEST(Load, TakesATissueOfTheSmoothLawThatRelaxes) {
  const TemporaryFolder folder;
  Overrides request;
  request.task = "press";
  request.tissue = folder
                       .write("soft.toml",
                              "[tissue]\nlaw=\"smooth\"\nk1_N_per_m=10\nbeta=1\nq=0.5\nrest_length_mm=10\n"
                              "max_length_mm=12\nmin_length_mm=8\nt1_us=1\n"
                              "[[tissue.relaxation]]\nshare = 0.3\ntime_s = 1.5\n")
                       .string();
  const model::TissueParameters tissue = load(request).tissue;
  EXPECT_EQ(tissue.law, model::LawKind::kSmooth);
  ASSERT_EQ(tissue.relaxation.size(), 1U);
  EXPECT_EQ(tissue.relaxation[0].tau, 1.5);
}

TEST(Load, ReadsFilesRelativeToTheScene) {
  const TemporaryFolder folder;
  (void)folder.write("box.obj", kBox);
  (void)folder.write("soft.toml",
                     "[tissue]\nk1_N_per_m=10\nbeta=1\nq=0.5\nrest_length_mm=10\nmax_length_mm=12\n"
                     "min_length_mm=5\nt1_us=1\n");
  (void)folder.write("way.csv", "time_s,x_m,y_m,z_m,gripper\n0,0,0,0,1\n");
  const scene::Scene scene =
      load(scene_of(folder.write("s.toml",
                                 "[scene]\ntask=\"pull\"\n[organ]\nmesh=\"box.obj\"\nunit=\"mm\"\n"
                                 "tissue=\"soft.toml\"\n[tool]\nmesh=\"sphere:3\"\n"
                                 "[device]\npath=\"way.csv\"\nworkspace_scale=3\n")));
  EXPECT_EQ(scene.organ_name, "box.obj");
  EXPECT_EQ(scene.organ.triangles.size(), 12U);
  EXPECT_NEAR(geometry::bounds(scene.organ).high.x(), 0.020, 1e-9);
  EXPECT_EQ(scene.tissue.name, "soft");
  EXPECT_EQ(scene.tissue.k1, 10.0);
  EXPECT_EQ(scene.devices[0].path, (folder.path() / "way.csv").string());
  EXPECT_EQ(scene.devices[0].workspace_scale, 3.0);
}

TEST(Load, FlagsOverrideTheScene) {
  const TemporaryFolder folder;
  const auto box = folder.write("box.obj", kBox);
  const auto way = folder.write("way.csv", "time_s,x_m,y_m,z_m,gripper\n0,0,0,0,1\n");
  Overrides request = scene_of(
      folder.write("s.toml", kShortLoaded + "[scene]\nname = \"mine\"\n[device]\nworkspace_scale = 2\n"));
  request.task = "pull";
  request.organ = box.string();
  request.organ_unit = "mm";
  request.tissue = "kidney";
  request.tools = {"sphere:2"};
  request.device = "scripted:" + way.string();
  request.rate_Hz = 2000.0;
  request.seed = 99;
  request.no_noise = true;
  const scene::Scene scene = load(request);
  EXPECT_EQ(scene.name, "mine");
  EXPECT_EQ(scene.task, Task::kPull);
  EXPECT_EQ(scene.organ.triangles.size(), 12U);
  EXPECT_EQ(scene.tissue.name, "kidney");
  EXPECT_DOUBLE_EQ(*scene.tools[0].tip_radius, 2e-3);
  EXPECT_EQ(scene.devices[0].path, way.string());
  EXPECT_EQ(scene.devices[0].workspace_scale, 2.0);
  EXPECT_EQ(scene.rate_Hz, 2000.0);
  EXPECT_EQ(scene.seed, 99U);
  EXPECT_EQ(scene.noise.seed, 99U);
  EXPECT_FALSE(scene.noise.enabled);
}

TEST(Load, SeveralToolFlagsAreJawsThatOpenApart) {
  const TemporaryFolder folder;
  const auto jaw = [&](const std::string& name, const std::string& y0, const std::string& y1) {
    return folder
        .write(name, "v -2 " + y0 + " 0\nv 2 " + y0 + " 0\nv 0 " + y1 + " 0\nv 0 " + y0 +
                         " 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        .string();
  };
  Overrides request;
  request.tools = {jaw("a.obj", "0", "2"), jaw("b.obj", "-0.1", "-2")};
  request.tool_unit = "mm";
  const scene::Scene scene = load(request);
  ASSERT_EQ(scene.tools.size(), 1U);
  ASSERT_EQ(scene.tools[0].parts.size(), 2U);
  double gap = 0.0;
  for (const std::size_t i : {0U, 1U}) {
    const geometry::ToolPart& part = scene.tools[0].parts[i];
    EXPECT_TRUE(part.is_jaw);
    const double y = (geometry::part_pose(part, 1.0) * Vec3(0.0, 0.0, 20e-3)).y();
    gap += i == 0 ? y : -y;
  }
  EXPECT_NEAR(gap, 2.0 * 20e-3 * 0.25881904510252074, 1e-12);  // sin 15 deg
}

TEST(Load, ANoiseClockThatIsNotGivenNeverRunsFasterThanTheLoop) {
  Overrides request;
  request.rate_Hz = 500.0;
  EXPECT_EQ(load(request).noise.rate_Hz, 500.0);
  request.rate_Hz = 4000.0;
  EXPECT_EQ(load(request).noise.rate_Hz, 1000.0);
  const TemporaryFolder folder;
  const Overrides given =
      scene_of(folder.write("s.toml", kShortLoaded + "[scene]\nrate_Hz = 500\n[noise]\nrate_Hz = 600\n"));
  EXPECT_THAT(error_in(given),
              HasSubstr("s.toml:8: noise.rate_Hz = 600: must be at most the loop's rate, 500 Hz"));
}

TEST(Load, RefusesBadFlagsByTheirName) {
  const auto with = [](auto change) {
    Overrides request;
    change(request);
    return error_in(request);
  };
  EXPECT_EQ(with([](Overrides& r) { r.task = "cut"; }),
            "--task = \"cut\": must be press, pull, palpate or insert");
  EXPECT_THAT(with([](Overrides& r) { r.organ = "lung"; }),
              HasSubstr("--organ = \"lung\": must be gallbladder"));
  EXPECT_THAT(with([](Overrides& r) { r.organ = "./lung.stl"; }),
              HasSubstr("--organ = \"./lung.stl\": its unit is missing, give --organ-unit"));
  EXPECT_EQ(with([](Overrides& r) { r.organ_unit = "feet"; }),
            "--organ-unit = \"feet\": must be mm, cm, m or in");
  EXPECT_EQ(with([](Overrides& r) { r.tool_unit = "feet"; }),
            "--tool-unit = \"feet\": must be mm, cm, m or in");
  EXPECT_THAT(with([](Overrides& r) {
                r.organ = "/no/such/lung.stl";
                r.organ_unit = "mm";
              }),
              HasSubstr("--organ: /no/such/lung.stl"));
  EXPECT_THAT(with([](Overrides& r) { r.tissue = "bone"; }), HasSubstr("--tissue: "));
  EXPECT_THAT(with([](Overrides& r) { r.tissue = "/no/such.toml"; }),
              HasSubstr("--tissue: /no/such.toml: there is no such file"));
  EXPECT_THAT(with([](Overrides& r) { r.tools = {"scissors"}; }),
              HasSubstr("--tool = \"scissors\": must be"));
  for (const double rate : {0.0, -1.0, 99.0, 20001.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(with([rate](Overrides& r) { r.rate_Hz = rate; }), HasSubstr("--rate-Hz = "));
  }
  EXPECT_THAT(with([](Overrides& r) { r.scene = "/no/such.toml"; }),
              HasSubstr("/no/such.toml: there is no such file"));
}

TEST(Load, ATouchIsNamedAndItsNameIsNoFile) {
  Overrides request;
  request.device = "touch:Left Device";
  const scene::Scene scene = load(request);
  EXPECT_EQ(scene.devices[0].kind, "touch");
  EXPECT_EQ(scene.devices[0].path, "Left Device");
}

TEST(Load, AClientsNameIsNoFileAndOnlyTheCommandLineLetsOtherMachinesConnect) {
  const TemporaryFolder folder;
  const auto text_with = [&](const std::string& device) {
    Overrides text;
    text.scene_text = SceneText{kShortLoaded + "[device]\nkind=\"igtl\"\n" + device, folder.path()};
    text.files_below = folder.path();
    return text;
  };
  EXPECT_EQ(load(text_with("path=\"18945/Hand\"")).devices[0].path, "18945/Hand");
  EXPECT_THAT(
      error_in(text_with("path=\"0.0.0.0:18945/Hand\"")),
      HasSubstr("\"0.0.0.0:18945/Hand\": must be PORT/NAME: a scene may let only this machine connect"));
  EXPECT_THAT(error_in(text_with("")), HasSubstr("needs path = \"PORT/NAME\" beside it"));
  Overrides request;
  request.device = "igtl:0.0.0.0:18945/Hand";
  EXPECT_EQ(load(request).devices[0].path, "0.0.0.0:18945/Hand");
  EXPECT_TRUE(load(request).files.empty());
}

TEST(Load, RefusesDevicesItCannotOpen) {
  const auto with = [](const std::string& device) {
    Overrides request;
    request.device = device;
    return error_in(request);
  };
  EXPECT_THAT(with("joystick"),
              HasSubstr("--device = \"joystick\": must be scripted, replay, emulated, mouse, gamepad, "
                        "forcedimension, haply, touch, igtl or ros; did you mean gamepad?"));
  for (const char* product : {"omega", "Omega.7", "sigma7", "delta:/opt/libdhd.so"}) {
    EXPECT_THAT(with(product), HasSubstr("did you mean forcedimension?")) << product;
  }
  EXPECT_THAT(with("inverse3"), HasSubstr("did you mean haply?"));
  EXPECT_THAT(with("spoon"), Not(HasSubstr("did you mean")));
  EXPECT_THAT(with("mouse:left"), HasSubstr("\"left\": must be left out: a mouse has none"));
  EXPECT_THAT(with("replay"), HasSubstr("needs the path of a recording"));
  EXPECT_THAT(with("replay:/no/such.h5"), HasSubstr("--device = \"/no/such.h5\": there is no such file"));
  EXPECT_THAT(with("scripted:/no/such.csv"), HasSubstr("there is no such file"));
  EXPECT_THAT(with("scripted:"), HasSubstr("must be KIND or KIND:PATH"));
  EXPECT_THAT(with("scripted:/"), HasSubstr("is a folder"));
}

TEST(Load, ALibraryIsNamedByItsAbsolutePathOnTheCommandLineAndNeverByAScene) {
  const TemporaryFolder folder;
  const std::string library = folder.write("libevil.so", "code").string();
  for (const std::string& named : {std::string("libevil.so"), library}) {
    const std::string device = "[device]\nkind=\"forcedimension\"\npath=\"" + named + "\"\n";
    const std::filesystem::path file = folder.write("s.toml", kShortLoaded + device);
    EXPECT_EQ(error_in(scene_of(file)),
              file.string() + ":7: device.path = \"" + named +
                  "\": must be left out: a scene may not name a library; link it into ~/.config/palpate, or "
                  "give its absolute path on the command line (docs/devices.md)");
    Overrides text;
    text.scene_text = SceneText{kShortLoaded + device, folder.path()};
    EXPECT_THAT(error_in(text), HasSubstr("a scene may not name a library"));
  }
  Overrides request;
  request.device = "forcedimension:" + library;
  EXPECT_EQ(load(request).devices[0].path, library);
  request.device = "forcedimension:libevil.so";
  EXPECT_THAT(error_in(request), HasSubstr("--device = \"libevil.so\": must be an absolute path"));
}

/// The error of a scene in that folder when its files must be inside the folder too.
std::string error_when_kept_inside(const TemporaryFolder& folder, const std::string& content) {
  Overrides request = scene_of(folder.write("s.toml", content));
  request.files_below = folder.path();
  return error_in(request);
}

TEST(Load, ASceneKeptToAFolderNamesNoFileOutsideAndQuotesNone) {
  const TemporaryFolder folder;
  const TemporaryFolder outside;
  const std::string secret = "root:$6$secret:19000:0\n";
  const std::string file = outside.write("shadow.toml", secret).string();
  std::filesystem::create_symlink(file, folder / "link.toml");
  std::filesystem::create_directory_symlink(outside.path(), folder / "linked");
  const std::string dots = "../" + outside.path().filename().string() + "/shadow.toml";
  for (const std::string& named : {file, std::string("link.toml"), std::string("linked/shadow.toml"), dots,
                                   outside.path().string() + "/not-there.toml"}) {
    const std::string name = " = \"" + named + "\"\n";
    const std::string organ = "[organ]\nmesh = \"gallbladder\"\n";
    const std::string tool = "[tool]\nmesh = \"sphere:3\"\n";
    for (const std::string& content :
         {"[organ]\nunit = \"mm\"\nmesh" + name + tool, organ + "tissue" + name + tool,
          organ + "[tool]\nunit = \"mm\"\nmesh" + name,
          organ + "[tool]\nunit = \"mm\"\n[[tool.jaw]]\nmesh" + name,
          organ + tool + "[device]\nkind = \"scripted\"\npath" + name,
          organ + tool + "[device]\nkind = \"replay\"\npath" + name}) {
      const std::string error = error_when_kept_inside(folder, content);
      EXPECT_THAT(error, HasSubstr("\"" + named + "\": must be a file below " + folder.path().string()));
      EXPECT_THAT(error, Not(HasSubstr("secret")));
    }
  }
  Overrides request = scene_of(file);
  request.files_below = folder.path();
  EXPECT_EQ(error_in(request), "scene = \"" + file + "\": must be a file below " + folder.path().string());
}

TEST(Load, ASceneKeptToAFolderTakesItsFilesBuiltInNamesAndAddresses) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "meshes");
  (void)folder.write("meshes/box.obj", kBox);
  std::filesystem::create_symlink("meshes/box.obj", folder / "same.obj");
  for (const char* mesh : {"meshes/box.obj", "same.obj", "meshes/../same.obj"}) {
    Overrides request = scene_of(folder.write(
        "s.toml", "[organ]\nmesh = \"" + std::string(mesh) +
                      "\"\nunit = \"mm\"\ntissue = \"liver\"\n[tool]\nmesh = \"sphere:3\"\n[device]\n"
                      "kind = \"haply\"\npath = \"ws://localhost:10001\"\n"));
    request.files_below = folder.path();
    EXPECT_EQ(load(request).organ.triangles.size(), 12U) << mesh;
  }
}

TEST(Load, RefusesWhatAScenesFilesDoWrong) {
  const TemporaryFolder folder;
  const std::string name = (folder.path() / "s.toml").string();
  const auto error_with = [&](const std::string& content) {
    return error_in(scene_of(folder.write("s.toml", content)));
  };
  EXPECT_THAT(error_with("[tool]\nmesh=\"sphere:3\"\n"),
              HasSubstr(name + ":1: organ.mesh: missing, must be a built-in"));
  EXPECT_THAT(error_with("[organ]\nmesh=\"heart\"\n"),
              HasSubstr("tool.mesh: missing, must be a built-in tool"));
  EXPECT_THAT(error_with("[organ]\nmesh=\"lung\"\n[tool]\nmesh=\"sphere:3\"\n"),
              HasSubstr(name + ":2: organ.mesh = \"lung\": must be gallbladder"));
  EXPECT_THAT(error_with("[organ]\nmesh=\"lung.stl\"\n[tool]\nmesh=\"sphere:3\"\n"),
              HasSubstr(name + ":2: organ.mesh = \"lung.stl\": its unit is missing, give organ.unit"));
  EXPECT_THAT(error_with("[organ]\nmesh=\"lung.stl\"\nunit=\"mm\"\n[tool]\nmesh=\"sphere:3\"\n"),
              HasSubstr(name + ":2: organ.mesh: " + folder.path().string() + "/lung.stl: "));
  EXPECT_THAT(
      error_with("[organ]\nmesh=\"heart\"\ntissue=\"no.toml\"\n[tool]\nmesh=\"sphere:3\"\n"),
      HasSubstr(name + ":3: organ.tissue: " + folder.path().string() + "/no.toml: there is no such file"));
  EXPECT_THAT(error_with(kShortLoaded + "[device]\nkind=\"spoon\"\n"),
              HasSubstr(name + ":6: device.kind = \"spoon\": must be scripted, replay"));
  EXPECT_THAT(error_with(kShortLoaded + "[device]\nkind=\"replay\"\n"),
              HasSubstr(name + ":6: device.kind = \"replay\": needs"));
  EXPECT_THAT(error_with(kShortLoaded + "[device]\npath=\"no.csv\"\n"),
              HasSubstr(name + ":6: device.path = \"no.csv\": there is no such file"));
  (void)folder.write("way.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n");
  EXPECT_THAT(error_with(kShortLoaded + "[scene]\ntask=\"pull\"\n[device]\npath=\"way.csv\"\n"),
              HasSubstr("way.csv:1: gripper: missing, a pull needs this column"));
  (void)folder.write("back.csv", "time_s,x_m,y_m,z_m\n1,0,0,0\n0,0,0,0\n");
  EXPECT_THAT(error_with(kShortLoaded + "[device]\npath=\"back.csv\"\n"),
              HasSubstr("back.csv:3: time_s = 0: must be later"));
}

TEST(Load, NamesAFileOfAnotherKindAndWhatReadsIt) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("box.obj", kBox).string();
  const std::string tissue = folder.write("soft.toml", "[tissue]\nname = \"soft\"\n").string();
  const std::string scene = folder.write("scene.toml", kShortLoaded).string();
  const std::string curve = folder.write("curve.csv", "displacement_mm,force_N\n0,0\n1,1\n").string();
  const std::string page = folder.write("report.html", "<!DOCTYPE html>\n<html></html>\n").string();
  EXPECT_THAT(error_in(scene_of(mesh)),
              HasSubstr("box.obj: is a mesh (OBJ), must be a scene; palpate run --organ "));
  EXPECT_THAT(error_in(scene_of(tissue)),
              HasSubstr("is a tissue file, must be a scene; --tissue FILE reads it"));
  Overrides request;
  request.tissue = scene;
  EXPECT_THAT(error_in(request), HasSubstr("is a scene, must be a tissue file; palpate run"));
  request = {};
  request.organ = tissue;
  EXPECT_THAT(error_in(request),
              AllOf(HasSubstr("--organ: "), HasSubstr("is a tissue file, must be a mesh file")));
  request = {};
  request.tools = {curve};
  request.tool_unit = "mm";
  EXPECT_THAT(error_in(request), HasSubstr("is a measured curve (CSV), must be a mesh file; palpate fit"));
  request.tools = {page};
  EXPECT_THAT(error_in(request),
              HasSubstr("is an HTML page, such as a report, must be a mesh file; open it"));
  request = {};
  request.device = "scripted:" + mesh;
  EXPECT_THAT(error_in(request), HasSubstr("is a mesh (OBJ), must be a CSV file"));
  request.device = "scripted:" + curve;
  EXPECT_THAT(error_in(request),
              HasSubstr("the file is a measured curve (CSV): palpate fit and validate read it"));
}

TEST(Load, RefusesAToolWithoutExtent) {
  const TemporaryFolder folder;
  std::string small = kBox;
  for (std::size_t at = small.find("20"); at != std::string::npos; at = small.find("20", at + 5))
    small.insert(at + 2, "e-9");
  Overrides request;
  request.tools = {folder.write("point.obj", small).string()};
  request.tool_unit = "mm";
  EXPECT_THAT(error_in(request),
              AllOf(HasSubstr("point.obj"), HasSubstr("the instrument's largest side is 4e-08 mm")));
}

TEST(Load, RepairsAnOrganAndKeepsWhatWasDone) {
  const TemporaryFolder folder;
  Overrides request;
  const auto damaged = folder.write("box.obj", kBox + "f 1 2 3\nf 1 1 2\n");
  request.organ = damaged.string();
  request.organ_unit = "mm";
  const scene::Scene scene = load(request);
  EXPECT_EQ(scene.organ.triangles.size(), 12U);
  EXPECT_THAT(scene.repairs,
              testing::ElementsAre(damaged.string() + ": dropped 1 triangle with two corners in one place",
                                   damaged.string() + ": dropped 1 duplicate triangle"));
  EXPECT_THAT(scene.remarks, testing::IsEmpty());
}

TEST(Load, RefusesOrgansThatAreTooLargeOrCannotBeRepaired) {
  const TemporaryFolder folder;
  const auto box = folder.write("box.obj", kBox);
  Overrides request;
  request.organ = box.string();
  request.organ_unit = "m";  // 40 m
  EXPECT_THAT(error_in(request), HasSubstr("--organ: "));
  request.organ = folder.write("open.obj", kBox.substr(0, kBox.rfind("f 3 8 7"))).string();
  request.organ_unit = "mm";
  EXPECT_THAT(error_in(request), testing::AllOf(HasSubstr("--organ: "),
                                                HasSubstr("cannot be an organ: a hole of 7 edges, 69.3 mm")));
}

TEST(Load, RefusesATissueWhoseLayersAreTooStiffByFileAndField) {
  const TemporaryFolder folder;
  const std::string tissue =
      "[tissue]\nname = \"jump\"\nk1_N_per_m = 18\nbeta = 0.02\nq = 0.7\nrest_length_mm = 14\n"
      "max_length_mm = 22\nmin_length_mm = 6\nt1_us = 1\n";
  Overrides request;
  request.tissue = folder.write("jump.toml", tissue).string();
  EXPECT_THAT(error_in(request),
              testing::AllOf(HasSubstr("--tissue"), HasSubstr("jump"), HasSubstr("beta = 0.02")));
}

TEST(Load, RefusesHandsThatDoNotMatchUp) {
  const TemporaryFolder folder;
  const std::string organ = "[organ]\nmesh=\"heart\"\n";
  const std::string tool = "[[tool]]\nmesh=\"sphere:3\"\n";
  const std::string device = "[[device]]\nkind=\"scripted\"\n";
  EXPECT_EQ(load(scene_of(folder.write("s.toml", organ + tool + tool))).devices.size(), 2U);
  EXPECT_EQ(load(scene_of(folder.write("s.toml", organ + tool + tool + device + device))).tools.size(), 2U);
  EXPECT_THAT(error_in(scene_of(folder.write("s.toml", organ + tool + tool + device))),
              HasSubstr("there are 1 devices for 2 tools, must be one per tool"));
  EXPECT_THAT(error_in(scene_of(folder.write("s.toml", organ + tool + tool + tool + tool + tool))),
              HasSubstr("there are 5 tools, must be at most 4"));
  Overrides request = scene_of(folder.write("s.toml", organ + tool + tool));
  request.tools = {"sphere:2"};
  EXPECT_THAT(error_in(request), HasSubstr("--tool = \"sphere:2\": the scene has several tools"));
  request.tools.clear();
  request.device = "scripted";
  EXPECT_THAT(error_in(request), HasSubstr("--device = \"scripted\": the scene has several hands"));
}

}  // namespace
}  // namespace palpate::scene
