#include "palpate/render/indentations.h"

#include <gtest/gtest.h>

namespace palpate::render {
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
  haptics::Snapshot snapshot;
  snapshot.hands = 1;
  snapshot.results[0].view_count = 1;
  snapshot.results[0].views[0] = view_of(0.004);
  const auto found = indentations_of(snapshot);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].point, Vec3(0.01, 0.02, 0.03));
  EXPECT_EQ(found[0].direction, Vec3(-Vec3::UnitZ()));
  EXPECT_EQ(found[0].depth, 0.004);
  EXPECT_EQ(found[0].tip_radius, 0.002);
  EXPECT_EQ(found[0].half_width, 0.0);
  snapshot.results[0].views[0].half_width = 0.0;  // not known
  EXPECT_EQ(indentations_of(snapshot)[0].tip_radius, 0.003);
}

TEST(Indentations, AreThoseOfAllHandsThatHaveDepth) {
  haptics::Snapshot snapshot;
  EXPECT_TRUE(indentations_of(snapshot).empty());
  snapshot.hands = 2;
  snapshot.results[0].view_count = 2;
  snapshot.results[0].views[0] = view_of(0.0);
  snapshot.results[0].views[1] = view_of(0.001);
  snapshot.results[1].view_count = 1;
  snapshot.results[1].views[0] = view_of(0.002);
  snapshot.results[2].view_count = 1;  // no such hand
  snapshot.results[2].views[0] = view_of(0.003);
  const auto found = indentations_of(snapshot);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].depth, 0.001);
  EXPECT_EQ(found[1].depth, 0.002);
}

}  // namespace
}  // namespace palpate::render
