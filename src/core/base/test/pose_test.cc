#include "palpate/pose.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/base/portable_math.h"

namespace palpate {
namespace {

constexpr double kTiny = 1e-14;

Quat random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Quat q(normal(random), normal(random), normal(random), normal(random));
  q.normalize();
  return q;
}

Vec3 random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

TEST(RotationFromDegrees, TurnsAboutOneAxisRightHanded) {
  EXPECT_TRUE((rotation_from_degrees({90, 0, 0}) * Vec3::UnitY()).isApprox(Vec3::UnitZ(), kTiny));
  EXPECT_TRUE((rotation_from_degrees({0, 90, 0}) * Vec3::UnitZ()).isApprox(Vec3::UnitX(), kTiny));
  EXPECT_TRUE((rotation_from_degrees({0, 0, 90}) * Vec3::UnitX()).isApprox(Vec3::UnitY(), kTiny));
}

// By hand: y -> (x by 90) z -> (y by 90) x -> (z by 90) y. Rotation about the turned axes would end
// elsewhere.
TEST(RotationFromDegrees, IsExtrinsicAboutXThenYThenZ) {
  EXPECT_TRUE((rotation_from_degrees({90, 90, 0}) * Vec3::UnitY()).isApprox(Vec3::UnitX(), kTiny));
  EXPECT_TRUE((rotation_from_degrees({90, 90, 90}) * Vec3::UnitY()).isApprox(Vec3::UnitY(), kTiny));
  EXPECT_TRUE((rotation_from_degrees({0, 90, 90}) * Vec3::UnitZ()).isApprox(Vec3::UnitY(), kTiny));
}

TEST(RotationAbout, MatchesRodriguesFormula) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random_point(random).normalized();
    const Vec3 p = random_point(random);
    const double angle = 6.0 * random_point(random).x();
    const Vec3 want =
        p * std::cos(angle) + axis.cross(p) * std::sin(angle) + axis * axis.dot(p) * (1 - std::cos(angle));
    EXPECT_LT((rotation_about(axis, angle) * p - want).norm(), kTiny);
  }
}

TEST(Slerp, GivesBothEnds) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Quat a = random_rotation(random);
    const Quat b = random_rotation(random);
    EXPECT_LT(slerp(a, b, 0.0).angularDistance(a), 1e-7);  // acos near 1 keeps half the digits
    EXPECT_LT(slerp(a, b, 1.0).angularDistance(b), 1e-7);
  }
}

// By hand: a quarter of the way from no turn to 80 degrees about z is 20 degrees about z.
TEST(Slerp, TurnsAtConstantSpeed) {
  const Quat a = rotation_from_degrees({0, 0, 0});
  const Quat b = rotation_from_degrees({0, 0, 80});
  for (const double u : {0.25, 0.5, 0.9}) {
    const Quat want = rotation_from_degrees({0, 0, 80 * u});
    EXPECT_LT((slerp(a, b, u).coeffs() - want.coeffs()).norm(), kTiny) << u;
  }
}

TEST(Slerp, TakesTheShorterArcWhateverTheSignOfTheQuaternion) {
  const Quat a = rotation_from_degrees({0, 0, 10});
  const Quat b = rotation_from_degrees({0, 0, 50});
  const Quat minus_b(-b.w(), -b.x(), -b.y(), -b.z());
  const Vec3 want = rotation_from_degrees({0, 0, 30}) * Vec3::UnitX();
  EXPECT_LT((slerp(a, minus_b, 0.5) * Vec3::UnitX() - want).norm(), kTiny);
}

TEST(Slerp, StaysUnitAndFiniteForEqualAndNearlyEqualRotations) {
  const Quat a = rotation_from_degrees({10, 20, 30});
  EXPECT_LT((slerp(a, a, 0.37).coeffs() - a.coeffs()).norm(), kTiny);
  for (const double gap : {1e-3, 3e-5, 1e-5, 1e-9}) {  // on both sides of the limit between arc and chord
    const Quat b = rotation_about(Vec3::UnitX(), gap) * a;
    const Quat want = rotation_about(Vec3::UnitX(), 0.5 * gap) * a;
    EXPECT_LT((slerp(a, b, 0.5).coeffs() - want.coeffs()).norm(), 1e-13) << gap;
    EXPECT_NEAR(slerp(a, b, 0.5).norm(), 1.0, kTiny);
  }
}

TEST(Pose, InverseUndoesIt) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Pose pose{random_rotation(random), random_point(random)};
    const Vec3 p = random_point(random);
    EXPECT_LT((pose.inverse() * (pose * p) - p).norm(), kTiny);
  }
}

TEST(Pose, ProductAppliesTheInnerOneFirst) {
  const Pose outer{rotation_from_degrees({0, 0, 90}), {1, 0, 0}};
  const Pose inner{Quat::Identity(), {0, 2, 0}};
  // By hand: the origin moves to (0, 2, 0), turns to (-2, 0, 0), moves to (-1, 0, 0).
  EXPECT_LT(((outer * inner) * Vec3::Zero() - Vec3(-1, 0, 0)).norm(), kTiny);
}

}  // namespace
}  // namespace palpate
