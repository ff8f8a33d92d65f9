// The section along a needle: its layers at rest, displaced, on both sides of the organ, and the layer of the
// tip.
#include "view/render/needle_section.h"

#include <limits>

#include <gtest/gtest.h>

#include "palpate/mesh.h"

namespace palpate::render {
namespace {

constexpr double kThickness = 20e-3;  // of the block [m]; its top is at z = 0

model::TissueLayer layer_of(double thickness) {
  model::TissueLayer layer;
  layer.thickness = thickness;
  return layer;
}

NeedleSection section_of_block() {
  geometry::TriangleMesh block = geometry::make_box({80e-3, 80e-3, kThickness}, 10e-3);
  geometry::transform(block, {Quat::Identity(), {0.0, 0.0, -kThickness / 2.0}});
  geometry::Needle needle;
  needle.length = 40e-3;  // the section ends 30 mm below the surface
  return {geometry::SignedDistance(block),
          {layer_of(2e-3), layer_of(3e-3), layer_of(std::numeric_limits<double>::infinity())},
          needle,
          model::FalloffRatios{}};
}

/// A needle above the block whose tip is at this height, pointing down.
Pose down_to(double z) { return {Quat(0.0, 1.0, 0.0, 0.0), {0.0, 0.0, z}}; }

constexpr std::size_t kMiddle = 12;  // column on the needle

TEST(NeedleSection, HasTheLayersInwardsAndInReverseOnTheFarSide) {
  NeedleSection section = section_of_block();
  const auto picture = section.picture(down_to(5e-3), {});
  ASSERT_TRUE(picture);
  const double edges[] = {0.0, 2e-3, 5e-3, 15e-3, 18e-3, 20e-3};
  const std::size_t layers[] = {0, 1, 2, 1, 0};
  ASSERT_EQ(picture->bands.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(picture->bands[i].layer, layers[i]);
    for (const std::size_t column : {std::size_t{0}, kMiddle, std::size_t{24}}) {
      EXPECT_NEAR(picture->bands[i].outer[column].along, edges[i], 1e-6) << i;
      EXPECT_NEAR(picture->bands[i].inner[column].along, edges[i + 1], 1e-6) << i;
    }
  }
  EXPECT_NEAR(picture->tip.along, -5e-3, 1e-9);
  EXPECT_FALSE(picture->layer);
}

TEST(NeedleSection, TheTissueIsDisplacedWithTheEntryAndTheTipIsInTheLayerThatHasMovedThere) {
  NeedleSection section = section_of_block();
  contact::ContactView view;
  view.direction_S = -Vec3::UnitZ();
  view.depth = 4e-3;
  view.tip_radius = 0.5e-3;
  const auto pressed = section.picture(down_to(-5e-3), {&view, 1});
  ASSERT_TRUE(pressed);
  EXPECT_NEAR(pressed->bands[0].outer[kMiddle].along, 4e-3, 1e-6);
  EXPECT_LT(pressed->bands[0].outer[0].along, 1e-3);
  EXPECT_EQ(pressed->layer, 0U) << "1 mm below the displaced surface";
  view.direction_S = Vec3::UnitZ();
  view.depth = 1e-3;
  const auto drawn_out = section.picture(down_to(-5e-3), {&view, 1});
  EXPECT_NEAR(drawn_out->bands[0].outer[kMiddle].along, -1e-3, 1e-6);
  EXPECT_EQ(drawn_out->layer, 2U) << "6 mm below the surface that is drawn out by 1 mm";
}

TEST(NeedleSection, FollowsANeedleThatMovesAsideAndIsNotShownFarFromTheOrgan) {
  NeedleSection section = section_of_block();
  ASSERT_TRUE(section.picture(down_to(5e-3), {}));
  Pose aside = down_to(5e-3);
  aside.position.x() = 30e-3;
  const auto moved = section.picture(aside, {});
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->tip.across, 0.0, 1e-9);
  EXPECT_EQ(moved->bands[0].outer.back().along, moved->bands[4].inner.back().along)
      << "no organ at x = 46 mm";
  aside.position.x() = 50e-3;
  EXPECT_FALSE(section.picture(aside, {})) << "past the block";
  EXPECT_FALSE(section.picture(down_to(60e-3), {}));
}

}  // namespace
}  // namespace palpate::render
