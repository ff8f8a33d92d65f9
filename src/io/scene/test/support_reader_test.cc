#include "io/scene/support_reader.h"

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

TEST(OrganSupport, IsDescribedByAPhraseForEachPart) {
  const auto stated = support_by_flags({"bed:0,0,-2,0.25", "faces:0,1,0", "at:45,-3.5,-2,6"});
  ASSERT_TRUE(stated);
  EXPECT_THAT(
      support_phrases(stated->support),
      testing::ElementsAre("a bed towards (0, 0, -2), 25 % of the extent", "all faces away from (0, 1, 0)",
                           "the surface within 6 mm of (45, -3.5, -2) mm"));
}

TEST(OrganSupport, ErrorsNameTheFieldAndWhatWouldBeRight) {
  EXPECT_THAT(support_error("[organ.support]\n"), HasSubstr("must have a bed, faces or an attachment"));
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
