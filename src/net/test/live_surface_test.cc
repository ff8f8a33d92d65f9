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

}  // namespace
}  // namespace palpate::net
