// Marks over the picture, and the words that tell how to begin.
#include "app/window/picture_marks.h"

#include <gtest/gtest.h>

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

TEST(PictureMarks, TheHintNamesOnlyWhatTheDeviceAndTheToolCanDo) {
  Gestures gestures;
  EXPECT_EQ(first_hint(gestures), "") << "a scripted device";
  gestures.mouse = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel.");
  gestures.jaws = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel.   Grip: hold left.");
  gestures.search = true;
  EXPECT_EQ(first_hint(gestures), "Move: mouse.   Press: wheel.   Mark: left button.");
  gestures = {.gamepad = true, .jaws = true};
  EXPECT_EQ(first_hint(gestures), "Move: left stick.   Press: right trigger.   Grip: left trigger.");
}

}  // namespace
}  // namespace palpate::app
