// The choices of the scene panel, without a display.
#include "app/window/choices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/builtin.h"

#include "app/window/scene_gallery.h"
#include "app/window/scene_pictures.h"

namespace palpate::app {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

scene::Scene pressed_ball() {
  scene::Scene scene;
  scene.organ_name = "ball";
  scene.tools = {geometry::make_tool("sphere:5")};
  scene.devices.resize(1);
  return scene;
}

TEST(Choices, EachOrganIsOneNameWithItsDetails) {
  EXPECT_THAT(organ_choices(), ElementsAre("gallbladder", "heart", "liver", "kidney", "ball", "box"));
  EXPECT_THAT(detail_choices("heart"), ElementsAre("", "-30k", "-300k"));
  EXPECT_THAT(detail_choices("ball"), ElementsAre(""));
  EXPECT_THAT(detail_choices("my-organ.stl"), IsEmpty());
  EXPECT_EQ(parts_of("heart-300k").base, "heart");
  EXPECT_EQ(parts_of("heart-300k").detail, "-300k");
  EXPECT_EQ(detail_text("-30k", "few"), "30,000 triangles");
}

TEST(Choices, EachToolIsOneNameWithItsDetails) {
  EXPECT_THAT(tool_choices(), ElementsAre("curved-forceps", "straight-forceps", "needle"));
  EXPECT_THAT(detail_choices("straight-forceps"), ElementsAre("", "-30k", "-300k"));
  EXPECT_THAT(detail_choices("sphere:5"), IsEmpty());
  EXPECT_EQ(parts_of("curved-forceps-30k").base, "curved-forceps");
  EXPECT_EQ(parts_of("curved-forceps").detail, "");
  EXPECT_EQ(detail_text("", "about 1,000 triangles"), "about 1,000 triangles");
}

TEST(Choices, APullTakesJawsAndKeepsTheOrgan) {
  const scene::Overrides request = with_task(pressed_ball(), {}, scene::Task::kPull);
  EXPECT_EQ(request.task, "pull");
  EXPECT_EQ(request.organ, "ball");
  EXPECT_THAT(request.tools, ElementsAre("straight-forceps"));
}

TEST(Choices, ATaskThatTheToolFitsKeepsIt) {
  const scene::Overrides request = with_task(pressed_ball(), {}, scene::Task::kPalpate);
  EXPECT_THAT(request.tools, ElementsAre("sphere:5"));
  scene::Scene forceps = pressed_ball();
  forceps.tools = {geometry::make_tool("curved-forceps")};
  EXPECT_THAT(with_task(forceps, {}, scene::Task::kPull).tools, ElementsAre("curved-forceps"));
}

TEST(Choices, ASceneFileKeepsItsOwnOrganAndTool) {
  scene::Overrides request;
  request.scene = "mine.toml";
  const scene::Overrides wanted = with_task(pressed_ball(), request, scene::Task::kPalpate);
  EXPECT_FALSE(wanted.organ);
  EXPECT_THAT(wanted.tools, IsEmpty());
}

TEST(Choices, WhatChangedWithASessionIsSaid) {
  Selection before{.task = "press",
                   .organ = "heart",
                   .tool = "sphere:5",
                   .device = "mouse",
                   .tissue = model::tissue_preset("liver")};
  Selection after = before;
  EXPECT_EQ(changes_text(before, after), "");
  after.task = "pull";
  after.tool = "straight-forceps";
  EXPECT_EQ(changes_text(before, after),
            "Now: task pull (before: press), tool straight-forceps (before: sphere:5).");
  after = before;
  before.tissue.k1 *= 2.0;
  EXPECT_EQ(changes_text(before, after), "Now: the scene's numbers of the tissue.");
  after.tissue = model::tissue_preset("heart");
  EXPECT_EQ(changes_text(before, after), "Now: tissue heart (before: liver).");
  after = before;
  before.noise.enabled = false;  // the default: 5e-5 N m / 5 mm = 10 mN
  EXPECT_EQ(changes_text(before, after), "Now: touch noise 10.0 mN (before: off).");
}

TEST(Gallery, TheUserTakesAScriptedSceneOverWithTheMouseAndKeepsADevice) {
  scene::Scene scene = pressed_ball();
  EXPECT_EQ(device_for_user(scene), "mouse");
  scene.devices.front().kind = "haply";
  scene.devices.front().path = "ws://localhost:10001";
  EXPECT_EQ(device_for_user(scene), "haply:ws://localhost:10001");
}

TEST(Gallery, EachSceneHasAPicture) {
  for (const scene::BuiltinScene& one : scene::builtin_scenes()) {
    const std::span<const unsigned char> png = scene_picture(one.name);
    ASSERT_GT(png.size(), 1000U) << one.name;
    EXPECT_THAT(std::string(png.begin(), png.begin() + 4), StartsWith("\x89PNG")) << one.name;
  }
  EXPECT_TRUE(scene_picture("no-such-scene").empty());
}

}  // namespace
}  // namespace palpate::app
