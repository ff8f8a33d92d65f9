#include "io/scene/search.h"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/signed_distance.h"
#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

// Six lines before `content`.
Scene search_scene(const std::string& content, std::uint64_t seed = 1, const std::string& organ = "liver") {
  const TemporaryFolder folder;
  Overrides request;
  request.scene = folder.write(
      "s.toml", "[scene]\ntask = \"palpate\"\n[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"" + organ +
                    "\"\n" + content);
  request.seed = seed;
  return load(request);
}

std::string search_error(const std::string& content) {
  return error_of([&] { (void)search_scene(content); });
}

TEST(Search, ASeedHidesTheSameThreeNodulesAndAnotherSeedOthers) {
  const Scene first = search_scene("", 7);
  ASSERT_EQ(first.inclusions.size(), 3U);
  for (const InclusionSetup& one : first.inclusions) {
    EXPECT_FALSE(one.visible);
    EXPECT_EQ(one.inclusion.ratio, 10.0);
    EXPECT_DOUBLE_EQ(one.inclusion.radius, 5e-3);
  }
  EXPECT_EQ(first.inclusions, search_scene("", 7).inclusions);
  EXPECT_NE(first.inclusions, search_scene("", 8).inclusions);
}

TEST(Search, LumpsLieInsideUnderTheUpperSideAndApart) {
  for (const char* organ : {"liver", "kidney", "gallbladder", "box"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Scene scene =
          search_scene("[search]\nlumps = 3\nradius_mm = 2\ndepth_mm = 4\ntolerance_mm = 5\n", seed, organ);
      const geometry::SignedDistance surface(scene.organ);
      for (const InclusionSetup& one : scene.inclusions) {
        const geometry::NearestPoint above = surface.nearest(one.inclusion.centre_S);
        EXPECT_LE(above.distance, -2e-3) << organ;
        EXPECT_GE(above.distance, -4.01e-3) << organ;
        EXPECT_GT((scene.organ_pose.rotation * (above.point - one.inclusion.centre_S)).z(), 0.0) << organ;
        for (const InclusionSetup& other : scene.inclusions) {
          if (&other == &one) continue;
          EXPECT_GT((other.inclusion.centre_S - one.inclusion.centre_S).norm(), 12e-3) << organ;
        }
      }
    }
  }
}

// A box has one upper side. Uniform over its area, a coordinate of 300 places is in each quarter of the side
// 75 +- 30 times (4 standard deviations of 7.5).
TEST(Search, PlacesAreUniformOverTheUpperSide) {
  Scene scene = search_scene("[search]\nlumps = 0\n", 1, "box");
  SearchTable table = read_search({});
  table.lumps = 1;
  table.lump.radius = table.depth = 0.5e-3;
  const double half = geometry::bounds(scene.organ).high.x();
  std::array<int, 4> quarters{};
  for (scene.seed = 0; scene.seed < 300; ++scene.seed) {
    scene.inclusions.clear();
    hide_inclusions(table, scene);
    const double x = scene.inclusions[0].inclusion.centre_S.x();
    ++quarters[static_cast<std::size_t>(std::clamp(static_cast<int>(2.0 * (x / half + 1.0)), 0, 3))];
  }
  for (const int count : quarters) EXPECT_NEAR(count, 75, 30);
}

TEST(Search, AScenesOwnHiddenInclusionIsTheOneToFind) {
  const std::string own = "[[organ.inclusion]]\npreset = \"stone\"\nvisible = false\n";
  EXPECT_EQ(search_scene(own).inclusions.size(), 1U);
  EXPECT_EQ(search_scene(own + "[search]\nlumps = 2\n").inclusions.size(), 3U);
  EXPECT_EQ(search_scene("[[organ.inclusion]]\npreset = \"stone\"\n").inclusions.size(), 4U);
}

TEST(Search, AnotherTaskHidesNothing) {
  const TemporaryFolder folder;
  Overrides request;
  request.scene = folder.write(
      "s.toml", "[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"liver\"\n[search]\nlumps = 3\n");
  EXPECT_TRUE(load(request).inclusions.empty());
  request.task = "palpate";
  EXPECT_EQ(load(request).inclusions.size(), 3U);
}

// A scene of task insert, with `content` from line 7 on.
/// @param organ an OFF file in mm, in place of the built-in box of 60 x 60 x 40 mm
Scene insertion_scene(const std::string& content, std::uint64_t seed = 1, const std::string& organ = "") {
  const TemporaryFolder folder;
  Overrides request;
  if (!organ.empty()) {
    request.organ = folder.write("organ.off", organ);
    request.organ_unit = "mm";
  }
  request.scene = folder.write("s.toml",
                               "[scene]\ntask = \"insert\"\n[tool]\nmesh = \"needle\"\n[organ]\nmesh = "
                               "\"box\"\n" +
                                   content);
  request.seed = seed;
  return load(request);
}

TEST(Search, TaskInsertHidesOneTargetAtAPlaceOfTheSeedAndOnlyWithTheTable) {
  const std::string table = "[search]\ndepth_mm = 17\n";
  const Scene first = insertion_scene(table, 7);
  ASSERT_EQ(first.inclusions.size(), 1U);
  EXPECT_FALSE(first.inclusions[0].visible);
  EXPECT_EQ(first.inclusions, insertion_scene(table, 7).inclusions);
  EXPECT_NE(first.inclusions, insertion_scene(table, 8).inclusions);
  EXPECT_TRUE(insertion_scene("").inclusions.empty());
  EXPECT_EQ(insertion_scene(table + "lumps = 2\nradius_mm = 1\ntolerance_mm = 5\n").inclusions.size(), 2U);
}

// The window's mouse starts where this path does.
TEST(Search, AHiddenTargetDoesNotMoveTheStartOfTheDefaultPathThatGoesToIt) {
  const Scene plain = insertion_scene("");
  for (const std::uint64_t seed : {7U, 8U}) {
    const Scene hides = insertion_scene("[search]\ndepth_mm = 17\n", seed);
    const ToolPath path = default_path(hides, 0);
    EXPECT_EQ(path.rows().front().position, default_path(plain, 0).rows().front().position);
    const Vec3& centre = hides.inclusions[0].inclusion.centre_S;
    const auto deepest =
        std::min_element(path.rows().begin(), path.rows().end(),
                         [](const PathRow& a, const PathRow& b) { return a.position.z() < b.position.z(); });
    EXPECT_NEAR(deepest->position.x(), centre.x(), 1e-3);  // the bevel's point is half the diameter aside
    EXPECT_NEAR(deepest->position.y(), centre.y(), 1e-3);
  }
}

TEST(Search, ATargetsLayersAreThoseOfTheTissue) {
  const Scene scene = insertion_scene(
      "tissue = \"epidural\"\n[target]\nlayer = \"epidural space\"\nforbidden = "
      "[\"dura\", \"spinal fluid\"]\n",
      1,
      "OFF\n8 12 0\n0 0 0\n99 0 0\n99 99 0\n0 99 0\n0 0 99\n99 0 99\n99 99 99\n0 99 99\n"
      "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n"
      "3 3 4 7\n");
  EXPECT_EQ(scene.target.layer, "epidural space");
  EXPECT_THAT(scene.target.forbidden, testing::ElementsAre("dura", "spinal fluid"));
  EXPECT_THAT(error_of([] { (void)insertion_scene("[target]\nlayer = \"dura\"\n"); }),
              HasSubstr("s.toml:8: target.layer = \"dura\": must be a layer of the tissue 'skin-fat-muscle': "
                        "skin, fat or muscle"));
  EXPECT_THAT(error_of([] { (void)insertion_scene("[target]\nforbidden = [\"skin\", \"bone\"]\n"); }),
              HasSubstr("s.toml:8: target.forbidden = \"bone\": must be a layer"));
  EXPECT_THAT(error_of([] { (void)insertion_scene("[target]\nlayers = \"skin\"\n"); }), HasSubstr("layer"));
}

// The box is 60 x 60 x 40 mm: its deepest point is 20 mm below the surface. The supraspinous ligament begins
// at 3 + 8 mm, the interspinous one at 15, the flavum at 33, the dura at 42.
TEST(Search, ATargetIsInTheOrganWithinTheNeedlesLengthAndNotForbidden) {
  const std::string epidural = "tissue = \"epidural\"\n[target]\n";
  EXPECT_NO_THROW((void)insertion_scene(epidural + "layer = \"interspinous ligament\"\n"));
  EXPECT_THAT(error_of([&] { (void)insertion_scene(epidural + "layer = \"ligamentum flavum\"\n"); }),
              HasSubstr("s.toml:9: target.layer = \"ligamentum flavum\": begins 33 mm below the surface, and "
                        "the organ's deepest point is 20 mm below it: must be a layer nearer to the surface, "
                        "or a thicker organ"));
  EXPECT_THAT(error_of([&] { (void)insertion_scene(epidural + "forbidden = [\"fat\", \"dura\"]\n"); }),
              HasSubstr("s.toml:9: target.forbidden = \"dura\": begins 42 mm below the surface"));
  EXPECT_THAT(error_of([&] { (void)insertion_scene(epidural + "layer = \"fat\"\nforbidden = [\"fat\"]\n"); }),
              HasSubstr("s.toml:10: target.forbidden = \"fat\": is the target too: must be another layer"));
  const std::string short_needle = "[tool]\nmesh = \"needle:18G,10,bevel\"\n";
  const auto with_short_needle = [&](const std::string& layer) {
    const TemporaryFolder folder;
    Overrides request;
    request.scene =
        folder.write("s.toml", "[scene]\ntask = \"insert\"\n" + short_needle + "[organ]\nmesh = \"box\"\n" +
                                   epidural + "layer = \"" + layer + "\"\n");
    return load(request);
  };
  EXPECT_EQ(with_short_needle("fat").target.layer, "fat");
  EXPECT_THAT(error_of([&] { (void)with_short_needle("supraspinous ligament"); }),
              HasSubstr("begins 11 mm below the surface: must be less than the needle's length, 10 mm"));
}

TEST(Search, RefusesWhatCannotBe) {
  EXPECT_THAT(search_error("[search]\nlumps = 9\n"),
              AllOf(HasSubstr("s.toml:8: search.lumps = 9"), HasSubstr("0 to 8")));
  EXPECT_THAT(search_error("[search]\npreset = \"stome\"\n"),
              AllOf(HasSubstr("s.toml:8: "), HasSubstr("stone")));
  EXPECT_THAT(search_error("[search]\nradius_mm = 60\n"), HasSubstr("radius_mm = 60"));
  EXPECT_THAT(search_error("[search]\nmark_button = 32\n"), HasSubstr("0 to 31"));
  EXPECT_THAT(search_error("[search]\nmark_button = 2\n[[device]]\nclutch_button = 2\n"),
              HasSubstr("clutch_button"));
  EXPECT_THAT(search_error("[search]\nradius_mm = 45\ndepth_mm = 46\n"),
              AllOf(HasSubstr("only 0 of 45 mm radius"), HasSubstr("must be fewer")));
  EXPECT_THAT(search_error("[search]\ntolerance = 5\n"), HasSubstr("tolerance_mm"));
}

TEST(Search, TheDefaultPathPressesTheUpperSideFromAbove) {
  const Scene scene = search_scene("");
  const geometry::SignedDistance surface(scene.organ);
  const ToolPath path = default_path(scene, 0);
  double deepest = 0.0;
  int presses = 0;
  bool inside = false;
  for (const PathRow& row : path.rows()) {
    // The lowest point of a ball of 5 mm is 5 mm below its centre, the handle.
    const Vec3 tip_S = scene.organ_pose.inverse() * (row.position - Vec3(0.0, 0.0, 5e-3));
    const geometry::NearestPoint nearest = surface.nearest(tip_S);
    deepest = std::min(deepest, nearest.distance);
    if (nearest.distance < -1e-3 && !inside) {
      ++presses;
      EXPECT_GT((scene.organ_pose.rotation * nearest.normal).z(), 0.3);
    }
    inside = nearest.distance < -1e-3;
  }
  EXPECT_LT(deepest, -5e-3);
  EXPECT_GE(deepest, -8.001e-3);
  EXPECT_GE(presses, 40);
  EXPECT_LE(presses, 60);
}

TEST(Search, TheMarkButtonsOfAPathAreReadAndHeldToTheNextRow) {
  const TemporaryFolder folder;
  const ToolPath path =
      read_tool_path(folder.write("p.csv", "time_s,x_m,y_m,z_m,buttons\n0,0,0,0,0\n1,0,0,0,5\n2,0,0,0,0\n"));
  EXPECT_EQ(path.at(0.5).buttons, 0U);
  EXPECT_EQ(path.at(1.0).buttons, 5U);
  EXPECT_EQ(path.at(1.9).buttons, 5U);
  EXPECT_EQ(path.at(2.0).buttons, 0U);
  EXPECT_THAT(error_of([&] {
                (void)read_tool_path(folder.write("q.csv", "time_s,x_m,y_m,z_m,buttons\n0,0,0,0,1.5\n"));
              }),
              AllOf(HasSubstr("q.csv:2: buttons = 1.5"), HasSubstr("whole number")));
}

}  // namespace
}  // namespace palpate::scene
