#include "core/geometry/ray.h"

#include <gtest/gtest.h>

namespace palpate::geometry {
namespace {

TEST(SeenPoint, IsTheNearestFaceTowardsTheEye) {
  const TriangleMesh box = make_box(Vec3(0.02, 0.04, 0.06), 0.005);
  const std::optional<Vec3> seen = seen_point(box, {Vec3(0.001, 0.002, 0.5), -Vec3::UnitZ()});
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->isApprox(Vec3(0.001, 0.002, 0.03), 1e-12));
}

TEST(SeenPoint, IsNoneBesideTheMeshAndBehindTheEye) {
  const TriangleMesh box = make_box(Vec3(0.02, 0.04, 0.06), 0.005);
  EXPECT_FALSE(seen_point(box, {Vec3(0.011, 0.0, 0.5), -Vec3::UnitZ()}));
  EXPECT_FALSE(seen_point(box, {Vec3(0.0, 0.0, 0.5), Vec3::UnitZ()}));
  EXPECT_FALSE(seen_point({}, {Vec3(0.0, 0.0, 0.5), -Vec3::UnitZ()}));
}

}  // namespace
}  // namespace palpate::geometry
