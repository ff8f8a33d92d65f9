// Scenes whose numbers are in another unit than their files say, and the frame and paths of a scene.
#include "io/scene/plausibility.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const auto kCubicRemark =
    HasSubstr("path.csv: cubics join its rows; interpolation = \"linear\" under [device]");

/// A box with an edge of 2 `half`, at `x` along x, as an OBJ file.
std::string box_obj(double half, double x = 0.0, const std::string& header = "") {
  std::string text = header;
  for (int i = 0; i < 8; ++i) {
    text += fmt::format("v {} {} {}\n", x + ((i + 1) / 2 % 2 == 1 ? half : -half),
                        i / 2 % 2 == 1 ? half : -half, i >= 4 ? half : -half);
  }
  return text +
         "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\n"
         "f 4 5 8\n";
}

/// A log of ten rows a second that goes down by 20 mm. @param metres in the unit of the file
std::string log_from(double z, double metres = 1.0) {
  std::string text = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 20; ++i) text += fmt::format("{:.1f},0,0,{}\n", 0.1 * i, metres * (z - 1e-3 * i));
  return text;
}

std::vector<std::string> remarks_of(const Overrides& request) { return load(request).remarks; }

class Plausibility : public testing::Test {
 protected:
  /// A scene with a box of 2 `half_mm` as the organ, and a ball as the tool.
  [[nodiscard]] Overrides with_organ(double half_mm, double x_mm = 0.0,
                                     const std::string& header = "") const {
    Overrides request;
    request.organ = folder_.write("organ.obj", box_obj(half_mm, x_mm, header)).string();
    request.organ_unit = "mm";
    request.tissue = "liver";
    request.tools = {"sphere:3"};
    return request;
  }
  [[nodiscard]] Overrides with_path(const std::string& path) const {
    Overrides request = with_organ(20.0);
    request.device = "scripted:" + folder_.write("path.csv", path).string();
    return request;
  }
  [[nodiscard]] Overrides with_tool(double half_mm, double x_mm = 0.0) const {
    Overrides request = with_organ(20.0);
    request.tools = {folder_.write("jaw.obj", box_obj(half_mm, x_mm)).string()};
    request.tool_unit = "mm";
    return request;
  }

  TemporaryFolder folder_;
};

TEST_F(Plausibility, AnInstrumentInMetresThatIsTakenAsMillimetresIsRefused) {
  const std::string why = error_of([&] { (void)load(with_tool(0.006)); });
  EXPECT_THAT(why, AllOf(HasSubstr("--tool = "), HasSubstr("jaw.obj"), HasSubstr("largest side is 0.012 mm"),
                         HasSubstr("is its unit right? (1000 times larger it would be 12 mm)")));
  EXPECT_THAT(error_of([&] { (void)load(with_tool(6000.0)); }),
              HasSubstr("1000 times smaller it would be 12 mm"));
}

TEST_F(Plausibility, AnUnusualInstrumentIsQuestionedAndAUsualOneIsNot) {
  Overrides ball;
  ball.tools = {"sphere:0.2"};
  EXPECT_THAT(remarks_of(ball), Contains(HasSubstr("sphere:0.2: the instrument's largest side is 0.4 mm")));
  ball.tools = {"sphere:0.02"};
  EXPECT_THROW((void)load(ball), InputError);
  EXPECT_THAT(remarks_of(with_tool(0.25)),
              Contains(HasSubstr("largest side is 0.5 mm, usual is 1 to 1000 mm")));
  EXPECT_THAT(remarks_of(with_tool(6.0)), IsEmpty());
}

TEST_F(Plausibility, ASmallPartOfAUsualInstrumentIsQuestioned) {
  Overrides request = with_tool(6.0);
  request.tools.push_back(folder_.write("pin.obj", box_obj(0.6)).string());
  EXPECT_THAT(remarks_of(request), IsEmpty());
  request.tools[1] = folder_.write("pin.obj", box_obj(0.006)).string();
  EXPECT_THAT(
      remarks_of(request),
      ElementsAre(HasSubstr("pin.obj: the part's largest side is 0.012 mm, usual "
                            "is 1 to 1000 mm: is its unit right? (1000 times larger it would be 12 mm)")));
  request.tools[1] = folder_.write("point.obj", box_obj(0.0)).string();
  EXPECT_THAT(error_of([&] { (void)load(request); }),
              AllOf(HasSubstr("point.obj"), HasSubstr("no triangles")));
}

TEST_F(Plausibility, JawsFromFilesAreCheckedBesideABuiltInShaft) {
  const auto with_jaw = [this](double half_mm) {
    (void)folder_.write("jaw.obj", box_obj(half_mm));
    Overrides request;
    request.scene = folder_.write("s.toml",
                                  "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\nunit = \"mm\"\n"
                                  "[[tool.jaw]]\nmesh = \"jaw.obj\"\n");
    return request;
  };
  EXPECT_THAT(error_of([&] { (void)load(with_jaw(0.006)); }),
              AllOf(HasSubstr("jaw.obj"), HasSubstr("largest side is 0.012 mm")));
  EXPECT_THAT(remarks_of(with_jaw(6.0)), IsEmpty());
}

TEST_F(Plausibility, AnInstrumentFarFromItsHandleIsRefusedOrQuestioned) {
  EXPECT_THAT(error_of([&] { (void)load(with_tool(6.0, 250e3)); }),
              HasSubstr("the instrument lies 249.994 m from the origin of its file, which is its handle"));
  EXPECT_THAT(remarks_of(with_tool(6.0, -3e3)),
              Contains(HasSubstr("the instrument lies 2.994 m from the origin")));
  EXPECT_THAT(remarks_of(with_tool(6.0, 500.0)), IsEmpty());
}

TEST_F(Plausibility, AnOrganOutOfReachIsRefusedWithItsPlaceAndAFarOneIsQuestioned) {
  const std::string why = error_of([&] { (void)load(with_organ(30.0, 250e3)); });
  EXPECT_THAT(why,
              AllOf(HasSubstr("--organ: the organ lies 250 m from the origin"),
                    HasSubstr("at x 249.97 to 250.03, y -0.03 to 0.03"), HasSubstr("must be within 50 m")));
  EXPECT_THAT(remarks_of(with_organ(30.0, -3e3)),
              Contains(HasSubstr("the organ lies 2.97 m from the origin")));
  EXPECT_THAT(remarks_of(with_organ(30.0, 1e3)), IsEmpty());
}

TEST_F(Plausibility, TheOrgansPoseCountsForItsPlace) {
  Overrides request;
  (void)folder_.write("organ.obj", box_obj(30.0, 250e3));
  request.scene = folder_.write("s.toml",
                                "[organ]\nmesh = \"organ.obj\"\nunit = \"mm\"\n"
                                "pose = { position_mm = [-250000, 0, 0] }\n[tool]\nmesh = \"sphere:3\"\n");
  EXPECT_THAT(remarks_of(request), IsEmpty());
}

TEST_F(Plausibility, APathInMillimetresIsQuestionedWithItsDistance) {
  EXPECT_THAT(remarks_of(with_path(log_from(0.065, 1e3))),
              Contains(AllOf(HasSubstr("path.csv: the tool comes no nearer to the organ than 44.977 m"),
                             HasSubstr("are x_m, y_m and z_m in mm?"))));
  EXPECT_THAT(remarks_of(with_path(log_from(0.065, 1e2))),
              Contains(HasSubstr("are x_m, y_m and z_m in mm or cm?")));
  EXPECT_THAT(remarks_of(with_path(log_from(0.5))), Contains(HasSubstr("are its positions in metres")));
  EXPECT_THAT(remarks_of(with_path(log_from(0.065))), ElementsAre(kCubicRemark));
}

TEST_F(Plausibility, AWorkspaceScaleCountsForAPathsDistance) {
  (void)folder_.write("path.csv", log_from(0.065, 1e3));
  Overrides request;
  request.scene = folder_.write("s.toml",
                                "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n"
                                "[device]\npath = \"path.csv\"\nworkspace_scale = 0.001\n");
  EXPECT_THAT(remarks_of(request), ElementsAre(kCubicRemark));
}

TEST_F(Plausibility, ALogWithUnixTimeIsRemarkedOnceInAScene) {
  std::string text = log_from(0.065);
  for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) {
    text.insert(at + 1, "163650000");  // before 0.0 to 2.0 s
  }
  EXPECT_THAT(remarks_of(with_path(text)),
              ElementsAre(HasSubstr("the path begins at 1636500000 s"), kCubicRemark));
}

TEST_F(Plausibility, TissueNumbersInOtherUnitsAreQuestioned) {
  model::TissueParameters tissue = model::tissue_preset("liver");
  EXPECT_THAT(tissue_remarks(tissue), IsEmpty());
  tissue.k1 = 0.018;
  EXPECT_THAT(tissue_remarks(tissue),
              Contains(HasSubstr("k1_N_per_m = 0.018, usual is 0.5 to 2e+04: is k1_N_per_m in "
                                 "N/cm? (it would be 1.8 N/m)")));
  tissue.rest_length *= 1e-3;
  tissue.min_length *= 1e-3;
  EXPECT_THAT(tissue_remarks(tissue), Contains(HasSubstr("is rest_length_mm in m?")));
}

TEST_F(Plausibility, EveryPresetIsUsual) {
  for (const char* name : {"gallbladder", "heart", "liver", "kidney"}) {
    EXPECT_THAT(tissue_remarks(model::tissue_preset(name)), IsEmpty()) << name;
  }
}

TEST_F(Plausibility, ALogBelow200RowsASecondIsCubicUnlessTheSceneSetsLinear) {
  EXPECT_EQ(load(with_path(log_from(0.065))).devices[0].interpolation, PathInterpolation::kCubic);
  Overrides request;
  request.scene = folder_.write("s.toml",
                                "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n"
                                "[device]\npath = \"path.csv\"\ninterpolation = \"linear\"\n");
  const Scene linear = load(request);
  EXPECT_EQ(linear.devices[0].interpolation, PathInterpolation::kLinear);
  EXPECT_THAT(linear.remarks, IsEmpty());
}

TEST_F(Plausibility, PathsOf200RowsASecondOrOfSomeCornersAreLinear) {
  std::string fast = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 20; ++i) fast += fmt::format("{},0,0,0.06\n", 0.005 * i);
  EXPECT_EQ(load(with_path(fast)).devices[0].interpolation, PathInterpolation::kLinear);
  const std::string corners = "time_s,x_m,y_m,z_m\n0,0,0,0.06\n1,0,0,0.03\n2,0,0,0.06\n";
  EXPECT_EQ(load(with_path(corners)).devices[0].interpolation, PathInterpolation::kLinear);
  EXPECT_EQ(load({}).devices[0].interpolation, PathInterpolation::kLinear) << "the default path";
}

TEST_F(Plausibility, PathsOfSeveralHandsHaveOneStart) {
  const auto starts = [this](double first, double second) {
    const auto log = [](double begin) {
      std::string text = "time_s,x_m,y_m,z_m\n";
      for (int i = 0; i <= 20; ++i) text += fmt::format("{:.1f},0,0,{}\n", begin + 0.1 * i, 0.065 - 1e-3 * i);
      return text;
    };
    (void)folder_.write("a.csv", log(first));
    (void)folder_.write("b.csv", log(second));
    Overrides request;
    request.scene = folder_.write(
        "s.toml",
        "[organ]\nmesh = \"box\"\n[[tool]]\nmesh = \"sphere:3\"\n[[tool]]\nmesh = \"sphere:3\"\n"
        "[[device]]\npath = \"a.csv\"\n[[device]]\npath = \"b.csv\"\n");
    std::vector<double> all;
    for (const DeviceSetup& device : load(request).devices) {
      all.push_back(read_tool_path(device.path, device.interpolation, nullptr, device.earliest_row)
                        .rows()
                        .front()
                        .time);
    }
    return all;
  };
  EXPECT_THAT(starts(1700000000.7, 1700000000.0), ElementsAre(testing::DoubleNear(0.7, 1e-6), 0.0));
  EXPECT_THAT(starts(0.0, 12.0), ElementsAre(0.0, 12.0)) << "the scene's clock";
  EXPECT_THAT(starts(112.0, 100.0), ElementsAre(12.0, 0.0));
  EXPECT_THAT(starts(-3.0, 0.0), ElementsAre(0.0, 3.0));
  EXPECT_THAT(starts(5.0, 7.0), ElementsAre(5.0, 7.0)) << "within ten seconds";
  EXPECT_THAT(
      error_of([&] { (void)starts(1700000000.5, 0.0); }),
      AllOf(HasSubstr("device.path = \"b.csv\": its first row is at 0 s, that of another hand's path at "
                      "1700000000.5 s: must count from the same start")));
  EXPECT_THAT(error_of([&] { (void)starts(0.0, 1700000000000.0); }), HasSubstr("in ms since 1970?"));
}

TEST_F(Plausibility, AnOrganHasTheFrameThatItsHeaderDeclares) {
  const Scene plain = load(with_organ(20.0));
  EXPECT_EQ(plain.organ_frame, OrganFrame::kRas);
  const auto declared = [this](const std::string& space) {
    Overrides request = with_organ(20.0, 0.0, "# 3D Slicer output. SPACE=" + space + "\n");
    request.igtl = true;
    return load(request);
  };
  const Scene lps = declared("LPS");
  EXPECT_EQ(lps.organ_frame, OrganFrame::kLps);
  EXPECT_EQ(lps.organ.vertices, plain.organ.vertices) << "Palpate's own frame is the file's";
  EXPECT_THAT(lps.remarks,
              Contains(HasSubstr("its header says SPACE=LPS: OpenIGTLink clients get it in RAS")));
  const Scene ras = declared("RAS");
  EXPECT_EQ(ras.organ_frame, OrganFrame::kRas);
  EXPECT_THAT(ras.remarks, IsEmpty());
  EXPECT_THAT(declared("LAI").remarks,
              Contains(HasSubstr("SPACE=LAI, which is neither RAS nor LPS: taken as RAS")));
}

TEST_F(Plausibility, TheFrameOfAnOrganIsReportedOnlyWithOpenIGTLink) {
  for (const char* space : {"LPS", "LAI"}) {
    Overrides request = with_organ(20.0, 0.0, fmt::format("# SPACE={}\n", space));
    EXPECT_THAT(remarks_of(request), IsEmpty());
    request.device = "igtl:18945/Hand";
    EXPECT_THAT(remarks_of(request), Contains(HasSubstr(fmt::format("its header says SPACE={}", space))));
  }
}

TEST_F(Plausibility, TheStatedFrameCountsMoreThanTheHeader) {
  Overrides request = with_organ(20.0, 0.0, "# 3D Slicer output. SPACE=LPS\n");
  request.organ_frame = "ras";
  request.igtl = true;
  const Scene scene = load(request);
  EXPECT_EQ(scene.organ_frame, OrganFrame::kRas);
  EXPECT_THAT(scene.remarks, Contains(HasSubstr("the scene's frame is used, ras")));
  request = with_organ(20.0);
  request.organ_frame = "lps";
  EXPECT_EQ(load(request).organ_frame, OrganFrame::kLps);
  request.organ_frame = "LPI";
  EXPECT_EQ(error_of([&] { (void)load(request); }), "--organ-frame = \"LPI\": must be ras or lps");
}

TEST_F(Plausibility, AClientsPosesAreTurnedToAnOrganInLps) {
  Overrides request = with_organ(20.0);
  request.device = "igtl:18945/Hand";
  EXPECT_EQ(load(request).devices[0].base * Vec3(0.03, 0.02, 0.01), Vec3(0.03, 0.02, 0.01));
  request.organ_frame = "lps";
  const Scene turned = load(request);
  EXPECT_EQ(turned.devices[0].base * Vec3(0.03, 0.02, 0.01), Vec3(-0.03, -0.02, 0.01));
  EXPECT_THAT(turned.remarks, IsEmpty());
}

TEST_F(Plausibility, ABaseCountsInsteadOfTheTurnToAnOrganInLpsAndIsReportedUnlessItTurns) {
  for (const std::string base : {"position_mm = [10, 0, 0]", "", "rotation_deg = [0, 0, 180]"}) {
    Overrides request = with_organ(20.0);
    request.scene = folder_.write("s.toml",
                                  "[organ]\nmesh = \"organ.obj\"\nunit = \"mm\"\nframe = \"lps\"\n"
                                  "[tool]\nmesh = \"sphere:3\"\n[device]\nkind = \"igtl\"\n"
                                  "path = \"18945/Hand\"\nbase = { " +
                                      base + " }\n");
    request.organ.reset();
    request.organ_unit.reset();
    const Scene scene = load(request);
    const bool turns = base.starts_with("rotation");
    EXPECT_NEAR(scene.devices[0].base.rotation.w(), turns ? 0.0 : 1.0, 1e-12) << base;
    if (turns) {
      EXPECT_THAT(scene.remarks, IsEmpty());
    } else {
      EXPECT_THAT(scene.remarks, Contains(HasSubstr("device igtl: its base is used as given")));
    }
  }
}

}  // namespace
}  // namespace palpate::scene
