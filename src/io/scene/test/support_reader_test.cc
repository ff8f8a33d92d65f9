#include "io/scene/support_reader.h"

#include <cmath>

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

Scene held_scene(const std::string& content, const std::vector<std::string>& flags = {}) {
  const TemporaryFolder folder;
  Overrides request;
  request.scene =
      folder.write("s.toml", "[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"box\"\n" + content);
  request.organ_support = flags;
  return load(request);
}

std::string support_error(const std::string& content, const std::vector<std::string>& flags = {}) {
  return error_of([&] { (void)held_scene(content, flags); });
}

TEST(OrganSupport, ReadsEveryPartIntoSi) {
  const Scene scene = held_scene(
      "[organ.support]\nbed = { direction = [0, 0, -2], share = 0.4 }\nfaces = { away_from = [1, 0, 0] }\n"
      "[[organ.support.attachment]]\npoint_mm = [1, 2, 19]\nradius_mm = 4\n");
  ASSERT_TRUE(scene.support);
  ASSERT_TRUE(scene.support->bed && scene.support->faces);
  EXPECT_EQ(scene.support->bed->direction, Vec3(0, 0, -2));
  EXPECT_EQ(scene.support->bed->share, 0.4);
  EXPECT_EQ(scene.support->faces->away_from, Vec3(1, 0, 0));
  ASSERT_EQ(scene.support->attachments.size(), 1U);
  EXPECT_LT((scene.support->attachments[0].point - Vec3(1e-3, 2e-3, 19e-3)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(scene.support->attachments[0].radius, 4e-3);
}

TEST(OrganSupport, FlagsAddUpAndReplaceTheScenes) {
  const std::string bed = "[organ.support]\nbed = { direction = [0, 0, -1] }\n";
  EXPECT_EQ(held_scene(bed).support->bed->share, geometry::kDefaultBedShare);
  const Scene scene = held_scene(bed, {"faces:0,0,1", "at:1,2,19,4.5"});
  ASSERT_TRUE(scene.support && scene.support->faces);
  EXPECT_FALSE(scene.support->bed);
  EXPECT_DOUBLE_EQ(scene.support->attachments.at(0).radius, 4.5e-3);
  EXPECT_FALSE(held_scene(bed, {"none"}).support);
  EXPECT_FALSE(held_scene("").support);
}

// A cube of 40 mm whose vertices at z = 40 have this colour, the others another.
std::string painted_cube(const std::string& above, const std::string& below) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 12\n"
      "property list uchar int vertex_indices\nend_header\n";
  for (const char* z : {"0 ", "40 "})
    for (const char* corner : {"0 0 ", "40 0 ", "40 40 ", "0 40 "})
      ply += corner + (z + (*z == '4' ? above : below)) + "\n";
  return ply +
         "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n"
         "3 3 0 4\n3 3 4 7\n";
}

Scene painted_scene(const TemporaryFolder& folder, const std::string& ply) {
  (void)folder.write("held.ply", ply);
  Overrides request;
  request.scene = folder.write("s.toml",
                               "[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"held.ply\"\nunit = \"mm\"\n"
                               "[organ.support]\npainted = \"held.ply\"\n");
  return load(request);
}

TEST(OrganSupport, RedVerticesOfAPlyFileAreHeldAsFarAsTheirEdges) {
  const TemporaryFolder folder;
  const Scene scene = painted_scene(folder, painted_cube("200 90 0", "200 120 0"));
  ASSERT_TRUE(scene.support);
  ASSERT_EQ(scene.support->painted.size(), 4U);
  for (const geometry::Attachment& place : scene.support->painted) {
    EXPECT_NEAR(place.point.z(), 0.04, 1e-9);
    EXPECT_NEAR(place.radius, 0.6 * 0.04 * std::sqrt(2.0), 1e-9);  // of the face's diagonal, or of an edge
  }
}

TEST(OrganSupport, APaintedFileWithoutRedOrColoursIsRefusedWithItsName) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { (void)painted_scene(folder, painted_cube("120 0 0", "0 255 0")); }),
              AllOf(HasSubstr("organ.support: painted: "), HasSubstr("held.ply: has no red vertex")));
  EXPECT_THAT(support_error("", {"painted:a.stl"}), HasSubstr("a.stl: must be a PLY file"));
  EXPECT_THAT(support_error("", {"painted:"}), HasSubstr("must be painted:FILE"));
}

TEST(OrganSupport, IsWrittenAsFlagsAndAsTomlThatGiveItAgain) {
  geometry::Support support;
  support.bed = geometry::Bed{Vec3(0.0, 0.5, -1.0), 0.35};
  support.faces = geometry::HeldFaces{Vec3(1, 0, 0)};
  support.attachments = {{Vec3(1.5e-3, -2e-3, 20e-3), 4.25e-3}, {Vec3(0.0, 0.0, 20e-3), 3e-3}};
  for (const Scene& scene : {held_scene("", support_flags(support)), held_scene(support_toml(support))}) {
    ASSERT_TRUE(scene.support);
    EXPECT_EQ(support_flags(*scene.support), support_flags(support));
    EXPECT_EQ(scene.support->bed->direction, support.bed->direction);
    ASSERT_EQ(scene.support->attachments.size(), 2U);
    EXPECT_LT((scene.support->attachments[0].point - support.attachments[0].point).norm(), 1e-12);
    EXPECT_NEAR(scene.support->attachments[0].radius, 4.25e-3, 1e-12);
  }
}

TEST(OrganSupport, IsDescribedByAPhraseForEachPart) {
  const auto stated = support_by_flags({"bed:0,0,-2,0.25", "faces:0,1,0", "at:45,-3.5,-2,6"});
  ASSERT_TRUE(stated);
  EXPECT_THAT(
      support_phrases(stated->support),
      testing::ElementsAre("a bed towards (0, 0, -2), 25 % of the extent", "all faces away from (0, 1, 0)",
                           "the surface within 6 mm of (45, -3.5, -2) mm"));
}

TEST(OrganSupport, ErrorsNameTheFieldAndWhatWouldBeRight) {
  EXPECT_THAT(support_error("[organ.support]\n"),
              HasSubstr("must have a bed, faces, an attachment or a painted mesh"));
  EXPECT_THAT(support_error("[organ.support]\nbed = { share = 0.2 }\n"),
              AllOf(HasSubstr("organ.support.bed.direction"), HasSubstr("missing")));
  EXPECT_THAT(support_error("[organ.support]\nbed = { direction = [0,0,1], share = 1.5 }\n"),
              HasSubstr("organ.support.bed.share = 1.5"));
  EXPECT_THAT(support_error("[organ.support]\nbed = { direction = [0,0,0] }\n"), HasSubstr("not zero"));
  EXPECT_THAT(support_error("[organ.support]\nfloor = 1\n"), HasSubstr("floor"));
  EXPECT_THAT(support_error("[[organ.support.attachment]]\npoint_mm = [0,0,0]\n"),
              AllOf(HasSubstr("radius_mm"), HasSubstr("missing")));
  EXPECT_THAT(support_error("[[organ.support.attachment]]\npoint_mm = [0,0,0]\nradius_mm = 900\n"),
              HasSubstr("radius_mm = 900"));
}

TEST(OrganSupport, AFlagInAnotherFormIsRefusedWithTheForms) {
  for (const char* flag :
       {"bed", "bed:0,0", "bed:0,0,x", "bed:0,0,1,0.3,5", "at:1,2,3", "table:0,0,1", "bed:nan,0,1"}) {
    EXPECT_THAT(support_error("", {flag}), AllOf(HasSubstr(flag), HasSubstr("bed:X,Y,Z"))) << flag;
  }
  EXPECT_THAT(support_error("", {"bed:0,0,1", "bed:0,1,0"}), HasSubstr("at most one"));
  EXPECT_THAT(support_error("", {"bed:0,0,1,2"}), HasSubstr("bed.share"));
  EXPECT_THAT(support_error("", {"at:0,0,20,0.5"}), HasSubstr("must hold at least 0.2 %"));
  EXPECT_THAT(support_error("", {"at:0,0,0.02,5"}),  // metres
              AllOf(HasSubstr("is 20 mm from the organ's surface"), HasSubstr("millimetres")));
}

}  // namespace
}  // namespace palpate::scene
