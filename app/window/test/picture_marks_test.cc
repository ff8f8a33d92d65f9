// Marks over the picture, and the words that tell how to begin.
#include "app/window/picture_marks.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "io/scene/make_world.h"

#include "app/window/panels.h"

namespace palpate::app {
namespace {

TEST(PictureMarks, AScaleBarIsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_NEAR(scale_bar_length(0.0501), 0.05, 1e-12);
  EXPECT_NEAR(scale_bar_length(0.049), 0.02, 1e-12);
  EXPECT_NEAR(scale_bar_length(0.0199), 0.01, 1e-12);
  EXPECT_NEAR(scale_bar_length(0.9), 0.5, 1e-12);
}

TEST(PictureMarks, AToolAboveThePictureIsOutOfFrameUnlessItIsFarFromTheOrgan) {
  const render::Camera camera{Vec3(0.0, -0.3, 0.0), Vec3::Zero(), Vec3::UnitZ(), 20.0};  // 106 mm high at 0
  haptics::Snapshot shown;
  shown.hands = 1;
  contact::ToolResult& result = shown.results[0];
  result.away_W = Vec3::UnitZ();
  result.distance = 40e-3;
  EXPECT_TRUE(contacts_in_frame(shown, camera, 1.0));
  result.distance = 52e-3;
  EXPECT_FALSE(contacts_in_frame(shown, camera, 1.0));
  result.distance = 90e-3;
  EXPECT_TRUE(contacts_in_frame(shown, camera, 1.0));
  result.distance = 0.0;  // a pull by 55 mm
  result.view_count = 1;
  result.views[0].direction_S = Vec3::UnitZ();
  result.views[0].depth = 55e-3;
  EXPECT_FALSE(contacts_in_frame(shown, camera, 1.0));
}

/// A needle whose tip is 6 mm inside the layers of the tissue skin-fat-muscle (2 mm, 6 mm), without
/// displacement.
TEST(PictureMarks, TheSectionOfANeedleNamesTheLayersAndShowsWhichTheTipIsIn) {
  scene::Overrides request;
  request.task = "insert";
  const scene::Scene scene = scene::load(request);
  const haptics::SimulationWorld world = scene::make_world(scene);
  std::optional<NeedleMarks> needle = NeedleMarks::of(scene, world.contact);
  ASSERT_TRUE(needle);
  haptics::Snapshot shown;
  shown.hands = 1;
  shown.organ_W = scene.organ_pose;
  const double top = geometry::bounds(scene.organ).high.z();
  shown.tools[0].pose_W =
      scene.organ_pose * Pose{Quat(0, 1, 0, 0), Vec3(0, 0, top - 6e-3 + scene.tools[0].needle->tip.z())};
  PictureMarks marks{.force = false, .scale = false, .axes = false};
  const PictureSize size{900.0F, 600.0F, 15.0F};
  const auto words_in = [&](const PictureSize& of) {
    std::vector<std::pair<std::string, bool>> found;
    for (const MarkShapes::Words& one : shapes_of(marks, of, {}, shown, &*needle).words) {
      found.emplace_back(one.text, one.colour == MarkShapes::Colour::kForce);
    }
    return found;
  };
  using Names = std::vector<std::pair<std::string, bool>>;
  EXPECT_EQ(words_in(size), (Names{{"skin", false}, {"fat", true}, {"muscle", false}}));
  EXPECT_EQ(words_in({390.0F, 600.0F, 15.0F}), (Names{{"fat", true}})) << "a narrow picture names one";
  EXPECT_FALSE(shapes_of(marks, {390.0F, 600.0F, 15.0F}, {}, shown, &*needle).triangles.empty());
  for (const double aside : {-22e-3, 22e-3}) {  // 8 mm from a side: its first column misses the muscle
    shown.tools[0].pose_W =
        scene.organ_pose *
        Pose{Quat(0, 1, 0, 0), Vec3(aside, 0, top - 12e-3 + scene.tools[0].needle->tip.z())};
    EXPECT_EQ(words_in(size), (Names{{"skin", false}, {"fat", false}, {"muscle", true}})) << aside;
  }
  marks.section = false;
  EXPECT_TRUE(shapes_of(marks, size, {}, shown, &*needle).triangles.empty());
  request.task = "press";
  EXPECT_FALSE(NeedleMarks::of(scene::load(request), world.contact));
}

TEST(MomentText, NamesTheLayerOfANeedlesTip) {
  model::TissueParameters tissue;
  tissue.layers.resize(2);
  tissue.layers[0].name = "skin";
  tissue.layers[1].name = "fat";
  haptics::TickRow row;
  row.phase = static_cast<std::uint32_t>(contact::Phase::kInsert);
  row.inserted_mm = 8.0;
  row.layer = 2;
  EXPECT_EQ(moment_text(row, tissue, 1), "8.0 mm inside, in fat");
}

TEST(PictureMarks, TheHintNamesOnlyWhatTheDeviceAndTheToolCanDo) {
  Gestures gestures;
  EXPECT_EQ(first_hint(gestures), "") << "a scripted device";
  gestures.mouse = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel forward.");
  gestures.jaws = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel forward.   Grip: hold left.");
  gestures.search = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel forward.   Mark: left button.");
  gestures = {.gamepad = true, .jaws = true};
  EXPECT_EQ(first_hint(gestures), "Move: left stick.   Press: right trigger.   Grip: left trigger.");
}

}  // namespace
}  // namespace palpate::app
