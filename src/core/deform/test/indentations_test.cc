#include <vector>

#include <gtest/gtest.h>

#include "palpate/surface.h"

namespace palpate::deform {
namespace {

contact::ContactView view_of(double depth) {
  contact::ContactView view;
  view.point_S = Vec3(0.01, 0.02, 0.03);
  view.direction_S = -Vec3::UnitZ();
  view.depth = depth;
  view.tip_radius = 0.003;
  view.half_width = 0.002;
  return view;
}

TEST(Indentations, AreTheContactsWithTipsNoBlunterThanWide) {
  std::vector<contact::ToolResult> results(1);
  results[0].view_count = 1;
  results[0].views[0] = view_of(0.004);
  const auto found = indentations_of(results);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].point, Vec3(0.01, 0.02, 0.03));
  EXPECT_EQ(found[0].direction, Vec3(-Vec3::UnitZ()));
  EXPECT_EQ(found[0].depth, 0.004);
  EXPECT_EQ(found[0].tip_radius, 0.002);
  EXPECT_EQ(found[0].half_width, 0.0);
  results[0].views[0].half_width = 0.0;  // unknown
  EXPECT_EQ(indentations_of(results)[0].tip_radius, 0.003);
}

TEST(Indentations, AreThoseOfAllHandsThatHaveDepth) {
  EXPECT_TRUE(indentations_of({}).empty());
  std::vector<contact::ToolResult> results(2);
  results[0].view_count = 2;
  results[0].views[0] = view_of(0.0);
  results[0].views[1] = view_of(0.001);
  results[1].view_count = 1;
  results[1].views[0] = view_of(0.002);
  const auto found = indentations_of(results);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].depth, 0.001);
  EXPECT_EQ(found[1].depth, 0.002);
}

}  // namespace
}  // namespace palpate::deform
