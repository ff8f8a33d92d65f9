#include "io/scene/variation_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/make_world.h"
#include "io/scene/scene_file.h"
#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

const std::string kBoxScene = "[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"box\"\n";  // four lines

Scene scene_with(const std::string& content, const std::vector<std::string>& flags = {}) {
  const TemporaryFolder folder;
  Overrides request;
  request.scene = folder.write("s.toml", kBoxScene + content);
  request.inclusions = flags;
  return load(request);
}

std::string variation_error(const std::string& content, const std::vector<std::string>& flags = {}) {
  return error_of([&] { (void)scene_with(content, flags); });
}

double top_of_box() { return geometry::bounds(scene_with("").organ).high.z(); }

TEST(InclusionTable, ReadsEveryFieldIntoSi) {
  const Scene scene = scene_with(
      "[[organ.inclusion]]\nname = \"a lump\"\nposition_mm = [1, -2, 3]\nradius_mm = 4\n"
      "stiffness_ratio = 12\nvisible = false\npulse_mm = 0.5\npulse_period_s = 1.5\n");
  ASSERT_EQ(scene.inclusions.size(), 1U);
  const InclusionSetup& one = scene.inclusions[0];
  EXPECT_EQ(one.name, "a lump");
  EXPECT_FALSE(one.visible);
  EXPECT_NEAR((one.inclusion.centre_S - Vec3(1e-3, -2e-3, 3e-3)).norm(), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(one.inclusion.radius, 4e-3);
  EXPECT_EQ(one.inclusion.ratio, 12.0);
  EXPECT_DOUBLE_EQ(one.inclusion.pulse, 0.5e-3);
  EXPECT_EQ(one.inclusion.pulse_period, 1.5);
}

TEST(InclusionTable, UnderAPlaceItLiesAtItsDepthAlongTheNormal) {
  const double top = top_of_box();
  const Scene scene = scene_with(
      "[[organ.inclusion]]\nunder = [10, 5, 1000]\ndepth_mm = 9\nradius_mm = 4\nstiffness_ratio = 12\n");
  EXPECT_NEAR((scene.inclusions[0].inclusion.centre_S - Vec3(10e-3, 5e-3, top - 9e-3)).norm(), 0.0, 1e-9);
}

TEST(InclusionTable, APresetAloneLiesUnderThePlaceOfTheDefaultPath) {
  const double top = top_of_box();
  for (const Scene& scene :
       {scene_with("[[organ.inclusion]]\npreset = \"stone\"\n"), scene_with("", {"stone"})}) {
    ASSERT_EQ(scene.inclusions.size(), 1U);
    EXPECT_EQ(scene.inclusions[0].name, "stone");
    EXPECT_EQ(scene.inclusions[0].inclusion.ratio, 100.0);
    EXPECT_NEAR(scene.inclusions[0].inclusion.centre_S.z(), top - 8e-3, 1e-9);
    EXPECT_LT(scene.inclusions[0].inclusion.centre_S.head<2>().norm(), 1e-6);
  }
}

TEST(InclusionTable, FlagsReplaceTheScenesInclusions) {
  const std::string stone = "[[organ.inclusion]]\npreset = \"stone\"\n";
  EXPECT_TRUE(scene_with(stone, {"none"}).inclusions.empty());
  const Scene scene = scene_with(stone, {"cyst", "nodule"});
  ASSERT_EQ(scene.inclusions.size(), 2U);
  EXPECT_EQ(scene.inclusions[0].name, "cyst");
}

TEST(InclusionTable, EveryMistakeIsNamedWithItsLineAndARemedy) {
  const std::string table = "[[organ.inclusion]]\n";
  EXPECT_THAT(variation_error(table + "preset = \"stome\"\n"),
              AllOf(HasSubstr("s.toml:6: organ.inclusion.preset = \"stome\""), HasSubstr("nodule")));
  EXPECT_THAT(variation_error(table + "radius_mm = 4\n"),
              HasSubstr("organ.inclusion.stiffness_ratio: missing"));
  EXPECT_THAT(variation_error(table + "radius_mm = 4\nstiffness_ratio = 5\n"),
              HasSubstr("organ.inclusion.position_mm: missing"));
  EXPECT_THAT(variation_error(table + "preset = \"stone\"\nstiffness_ratio = 101\n"),
              HasSubstr("organ.inclusion.stiffness_ratio = 101: must be a number >= 0.1 and <= 100"));
  EXPECT_THAT(variation_error(table + "preset = \"stone\"\nradius_mm = 9\n"),
              AllOf(HasSubstr("8 mm below the surface"), HasSubstr("at least 9 mm")));
  EXPECT_THAT(variation_error(table + "preset = \"stone\"\nposition_mm = [0, 0, 500]\n"),
              HasSubstr("outside the organ"));
  EXPECT_THAT(variation_error(table + "preset = \"stone\"\nradius = 9\n"),
              HasSubstr("did you mean radius_mm?"));
  EXPECT_THAT(variation_error("", {"lump"}), HasSubstr("--inclusion = \"lump\": must be nodule, "));
  std::string nine;
  for (int i = 0; i < 9; ++i) nine += table + "preset = \"stone\"\n";
  EXPECT_THAT(variation_error(nine), HasSubstr("must be at most 8"));
}

/// Two spheres of 4 mm and 5 mm radius whose centres are `apart_mm` apart.
std::string two_spheres(const std::string& apart_mm, const std::string& more = "") {
  const std::string table = "[[organ.inclusion]]\nstiffness_ratio = 2\nradius_mm = ";
  return table + "4\nname = \"left\"\nposition_mm = [0, 0, 5]\n" + table +
         "5\nname = \"right\"\nposition_mm = [" + apart_mm + ", 0, 5]\n" + more;
}

TEST(OverlapRemarks, NameTwoVisibleInclusionsThatOverlap) {
  EXPECT_THAT(overlap_remarks(scene_with(two_spheres("8.9"))),
              testing::ElementsAre(AllOf(HasSubstr("'left' and 'right' overlap"), HasSubstr("8.9 mm apart"),
                                         HasSubstr("radii, 9 mm"))));
  EXPECT_THAT(overlap_remarks(scene_with(two_spheres("9.1"))), testing::IsEmpty());
}

TEST(OverlapRemarks, NeverTellOfAHiddenInclusion) {
  EXPECT_THAT(overlap_remarks(scene_with(two_spheres("1", "visible = false\n"))), testing::IsEmpty());
}

}  // namespace
}  // namespace palpate::scene
