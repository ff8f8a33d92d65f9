#include "net/live_surface.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "net/live_protocol.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/tissue.h"

namespace palpate::net {
namespace {

const model::FalloffRatios kReach = model::tissue_preset("liver").reach;

TEST(LiveSurface, AtRestHasEveryVertexInMillimetresAndEveryTriangle) {
  const geometry::TriangleMesh box = geometry::make_organ("box");
  const auto json = LiveSurface(box).at_rest();
  ASSERT_EQ(json["vertices_mm"].size(), 3 * box.vertices.size());
  ASSERT_EQ(json["triangles"].size(), 3 * box.triangles.size());
  for (std::size_t i = 0; i < box.vertices.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(json["vertices_mm"][3 * i + axis].get<double>(),
                  1e3 * box.vertices[i][static_cast<int>(axis)], 5.01e-4);
    }
  }
  EXPECT_EQ(json["triangles"][4], box.triangles[1][1]);
}

TEST(LiveSurface, WhatHasMovedIsUnderTheToolAndNothingElseIsSent) {
  const geometry::TriangleMesh box = geometry::make_organ("box");
  LiveSurface surface(box);
  EXPECT_TRUE(surface.moved(kReach, {})["moved"].empty());
  deform::Indentation press;
  press.point = Vec3(0.0, 0.0, 0.02);  // the middle of the box's top
  press.direction = Vec3(0.0, 0.0, -1.0);
  press.depth = 3e-3;
  press.tip_radius = 5e-3;
  const auto json = surface.moved(kReach, {press});
  ASSERT_EQ(json["vertices_mm"].size(), 3 * json["moved"].size());
  double deepest = 0.0;
  for (std::size_t i = 0; i < json["moved"].size(); ++i) {
    const Vec3& rest = box.vertices.at(json["moved"][i].get<std::size_t>());
    EXPECT_NEAR(json["vertices_mm"][3 * i].get<double>(), 1e3 * rest.x(), 1e-3);
    deepest = std::max(deepest, 1e3 * rest.z() - json["vertices_mm"][3 * i + 2].get<double>());
  }
  EXPECT_NEAR(deepest, 3.0, 1e-2);
  EXPECT_LT(json["moved"].size(), box.vertices.size());
  EXPECT_TRUE(surface.moved(kReach, {})["moved"].empty()) << "it goes back to rest";
}

TEST(LiveSurface, AnOrganThatIsTooFineIsRefusedWithItsSize) {
  const geometry::TriangleMesh fine = geometry::make_ball(0.03, 20'001);
  try {
    const LiveSurface surface(fine);
    FAIL() << "it was taken";
  } catch (const LiveError& error) {
    EXPECT_EQ(error.code(), "refused");
    EXPECT_THAT(error.what(), testing::HasSubstr(std::to_string(fine.triangles.size()) +
                                                 " triangles, must have at most 20000"));
  }
}

TEST(LiveTool, HasTheMeshOfEachPartAndHowJawsTurn) {
  const geometry::Tool tool = geometry::make_tool("straight-forceps");
  const auto json = tool_json(tool);
  ASSERT_EQ(json["parts"].size(), tool.parts.size());
  std::size_t jaws = 0;
  for (std::size_t i = 0; i < tool.parts.size(); ++i) {
    const auto& part = json["parts"][i];
    EXPECT_EQ(part["triangles"].size(), 3 * tool.parts[i].mesh.triangles.size());
    EXPECT_NEAR(part["vertices_mm"][2].get<double>(), 1e3 * tool.parts[i].mesh.vertices[0].z(), 5.01e-4);
    EXPECT_EQ(part.contains("open_deg"), tool.parts[i].is_jaw);
    if (!tool.parts[i].is_jaw) continue;
    ++jaws;
    EXPECT_NEAR(part["open_deg"].get<double>(), tool.parts[i].open_angle * 180.0 / 3.141592653589793, 1e-9);
    EXPECT_NEAR(part["pivot_mm"][2].get<double>(), 1e3 * tool.parts[i].pivot.z(), 1e-9);
  }
  EXPECT_EQ(jaws, 2U);
}

TEST(LiveTool, ThatIsTooFineIsRefusedWithItsSize) {
  geometry::Tool tool;
  tool.parts.resize(2);
  for (geometry::ToolPart& part : tool.parts) part.mesh = geometry::make_ball(0.03, 15'000);
  try {
    (void)tool_json(tool);
    FAIL() << "it was taken";
  } catch (const LiveError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("must have at most 20000"));
  }
}

TEST(LivePicture, HasThePosesAndContactsOfEveryHand) {
  haptics::Snapshot snapshot;
  snapshot.tick = 7;
  snapshot.hands = 2;
  snapshot.organ_W.position = Vec3(0.01, 0.02, 0.03);
  snapshot.tools[1].pose_W = {Quat(0.0, 1.0, 0.0, 0.0), Vec3(0.1, 0.2, 0.3)};
  snapshot.tools[1].gripper = 0.25;
  snapshot.results[1].view_count = 1;
  contact::ContactView& view = snapshot.results[1].views[0];
  view.point_S = Vec3(1e-3, 2e-3, 3e-3);
  view.direction_S = Vec3(0.0, 0.0, -1.0);
  view.depth = 4e-3;
  view.tip_radius = 5e-3;
  view.half_width = 6e-3;
  view.pull = true;
  const auto json = picture_json(snapshot);
  EXPECT_EQ(json["tick"], 7);
  EXPECT_EQ(json["organ_m"][1], 0.02);
  EXPECT_TRUE(json["hands"][0]["contacts"].empty());
  const auto& hand = json["hands"][1];
  EXPECT_EQ(hand["tool_m"][2], 0.3);
  EXPECT_EQ(hand["tool_wxyz"][1], 1.0);
  EXPECT_EQ(hand["gripper"], 0.25);
  ASSERT_EQ(hand["contacts"].size(), 1U);
  const auto& contact = hand["contacts"][0];
  EXPECT_EQ(contact["point_m"][0], 1e-3);
  EXPECT_EQ(contact["direction"][2], -1.0);
  EXPECT_EQ(contact["depth_m"], 4e-3);
  EXPECT_EQ(contact["tip_radius_m"], 5e-3);
  EXPECT_EQ(contact["half_width_m"], 6e-3);
  EXPECT_EQ(contact["pull"], true);
}

}  // namespace
}  // namespace palpate::net
