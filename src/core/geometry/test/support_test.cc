#include "palpate/support.h"

#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::geometry {
namespace {

// 40 x 20 x 10 mm: sides of 800 (z), 400 (y) and 200 (x) mm^2, twice each; 2800 mm^2 in all.
TriangleMesh box() { return make_box(Vec3(0.04, 0.02, 0.01), 1e-3); }

Support bed(double share) {
  Support support;
  support.bed = Bed{-Vec3::UnitZ() * 7.0, share};
  return support;
}

TEST(Support, ABedHoldsTheBottomAndTheLowestShareOfTheSides) {
  // The bottom, and 0.3 of the four sides.
  EXPECT_NEAR(held_share(bed(0.3), box()), (800.0 + 0.3 * 1200.0) / 2800.0, 1e-9);
}

TEST(Support, FacesThatLookAwayAreHeld) {
  Support support;
  support.faces = HeldFaces{Vec3::UnitX()};
  EXPECT_NEAR(held_share(support, box()), 200.0 / 2800.0, 1e-9);
}

TEST(Support, AnAttachmentHoldsADiscAroundTheNearestPoint) {
  Support support;
  support.attachments.push_back({Vec3(0.0, 0.0, 0.009), 5e-3});  // 4 mm above the top
  EXPECT_NEAR(held_share(support, box()), 25.0 * 3.14159265 / 2800.0, 2e-3);
}

TEST(Support, PaintedPlacesHoldWhatIsWithinTheirRadius) {
  Support support;  // two discs on the top, apart, and one that is far larger beside the organ
  support.painted = {
      {Vec3(-0.01, 0.0, 0.005), 4e-3}, {Vec3(0.01, 0.0, 0.005), 2e-3}, {Vec3(0.2, 0, 0), 0.01}};
  EXPECT_NEAR(held_share(support, box()), (16.0 + 4.0) * 3.14159265 / 2800.0, 2e-3);
  support.painted.front().radius = -1.0;
  EXPECT_THROW(validate(support), InputError);
}

TEST(Support, PartsAddUp) {
  Support support = bed(0.3);
  support.faces = HeldFaces{-Vec3::UnitZ()};  // the top
  EXPECT_NEAR(held_share(support, box()), (1600.0 + 0.3 * 1200.0) / 2800.0, 1e-9);
}

TEST(Support, InvalidNumbersAreRefusedByTheirKeys) {
  EXPECT_THROW(validate(Support{}), InputError);
  EXPECT_THROW(validate(bed(0.0)), ParameterError);
  EXPECT_THROW(validate(bed(0.95)), ParameterError);
  Support still;
  still.faces = HeldFaces{Vec3::Zero()};
  EXPECT_THROW(validate(still), InputError);
  Support point;
  point.attachments.push_back({Vec3::Zero(), 0.0});
  EXPECT_THROW(validate(point), ParameterError);
}

TEST(Support, AnAttachmentFartherFromTheSurfaceThanItsRadiusIsRefused) {
  Support support;
  support.attachments.push_back({Vec3(0.0, 0.0, 0.0095), 5e-3});  // 4.5 mm above the top
  EXPECT_NO_THROW(check_support(support, box()));
  support.attachments[0].point.z() = 0.0105;
  EXPECT_THROW(check_support(support, box()), InputError);
}

TEST(Support, HoldingNothingOrAllIsRefused) {
  Support small;
  small.attachments.push_back({Vec3(0.0, 0.0, 5e-3), 0.6e-3});
  EXPECT_THROW(check_support(small, box()), InputError);
  Support all;
  all.attachments.push_back({Vec3::Zero(), 0.1});
  EXPECT_THROW(check_support(all, box()), InputError);
  EXPECT_NO_THROW(check_support(bed(0.3), box()));
}

}  // namespace
}  // namespace palpate::geometry
