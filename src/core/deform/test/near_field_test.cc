#include "core/deform/near_field.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr double kCell = 12e-3;

NearField near_field(const Vec3& point, const Vec3& inward, double radius, const Vec3& force) {
  NearField field;
  field.place(point, inward);
  field.set_terms(radius, kCell, kCell);
  field.set_force(force);
  return field;
}

Vector3f motion_at(const NearField& field, const Vector3f& vertex) {
  const Float4x3 none{Float4(0.0F), Float4(0.0F), Float4(0.0F)};
  FourMotions motions{none, {none, none, none}};
  field.add(lanes_of(vertex), motions);
  return motions.first().displacement;
}

TEST(NearField, TurnsTheCellsContactIntoTheTools) {
  // On the surface of a half-space: the cells' spread field plus the near field is the tool's field.
  const NearField field = near_field(Vec3::Zero(), Vec3::UnitZ(), 3e-3, Vec3(0.0, 0.0, 2.0));
  for (const double r : {0.0, 2e-3, 5e-3, 11e-3, 20e-3}) {
    const auto under = [r](double radius) {
      return 2.0 * 2.0 * (1.0 - kPoisson) * half_space_terms(r, radius).psi / kHalfSpaceModulus;
    };
    const double lacks = under(3e-3) - under(kCell);
    EXPECT_NEAR(motion_at(field, Vec3(r, 0.0, 0.0).cast<float>()).z(), lacks, 5e-3 * under(3e-3)) << r;
  }
}

TEST(NearField, DoesNotJumpOnTheLineThroughTheOrgan) {
  const NearField field = near_field(Vec3::Zero(), Vec3::UnitZ(), 3e-3, Vec3(0.0, 0.0, 2.0));
  const Vector3f left = motion_at(field, Vector3f(-1e-6F, 0.0F, 15e-3F));
  const Vector3f right = motion_at(field, Vector3f(1e-6F, 0.0F, 15e-3F));
  EXPECT_LT((right - left).norm(), 1e-3F * right.norm());
}

TEST(NearField, EndsThreeAndAHalfCellsAway) {
  const NearField field = near_field(Vec3::Zero(), Vec3::UnitZ(), 3e-3, Vec3(1.0, 0.0, 2.0));
  EXPECT_GT(motion_at(field, Vector3f(3.0F * 12e-3F, 0.0F, 0.0F)).norm(), 0.0F);
  EXPECT_EQ(motion_at(field, Vector3f(3.5001F * 12e-3F, 0.0F, 0.0F)).norm(), 0.0F);
}

TEST(NearField, MovesFourPlacesAsEachAlone) {
  const NearField field = near_field(Vec3::Zero(), Vec3::UnitZ(), 3e-3, Vec3(0.7, 0.2, 2.0));
  const std::array<Vector3f, kLanes> places = {Vector3f(1e-3F, 2e-3F, 0.0F), Vector3f(0.0F, 0.5F, 0.0F),
                                               Vector3f::Zero(), Vector3f(-9e-3F, 1e-3F, 7e-3F)};
  const auto axis = [&places](Eigen::Index k) {
    return Float4(std::array<float, kLanes>{places[0][k], places[1][k], places[2][k], places[3][k]});
  };
  const Float4x3 none{Float4(0.0F), Float4(0.0F), Float4(0.0F)};
  FourMotions motions{none, {none, none, none}};
  field.add({axis(0), axis(1), axis(2)}, motions);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    FourMotions alone{none, {none, none, none}};
    field.add(lanes_of(places[lane]), alone);
    EXPECT_EQ(motions.displacement.z.get(lane), alone.displacement.z.get(0)) << lane;
    EXPECT_EQ(motions.gradient[1].x.get(lane), alone.gradient[1].x.get(0)) << lane;
  }
}

// A vector of a length, in any direction.
Vec3 random_vector(std::mt19937& random, double length) {
  std::normal_distribution<double> normal;
  Vec3 v;
  for (double& x : v) x = normal(random);
  return length * v.normalized();
}

TEST(NearFieldChange, BoundsTheMotionOfEveryVertex) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 inward = random_vector(random, 1.0);
    const double radius = 1e-3 + 6e-3 * share(random);
    const Vec3 force = random_vector(random, share(random));
    const NearField before = near_field(Vec3::Zero(), inward, radius, force);
    const Vec3 drift = random_vector(random, trial % 3 == 0 ? 0.0 : 2e-3 * share(random));
    const Vec3 turned =
        (inward + random_vector(random, trial % 4 == 0 ? 0.0 : 0.2 * share(random))).normalized();
    const Vec3 changed = force + random_vector(random, trial % 5 == 0 ? 0.0 : 0.2 * share(random));
    const NearField now = near_field(drift, turned, radius * (0.8 + 0.4 * share(random)), changed);
    NearFieldChange change;
    change.set(trial % 7 == 0 ? nullptr : &before, trial % 11 == 5 ? nullptr : &now);
    for (int i = 0; i < 200; ++i) {
      const Vector3f vertex = random_vector(random, 0.05 * share(random)).cast<float>();
      const Vector3f then = trial % 7 == 0 ? Vector3f::Zero() : motion_at(before, vertex);
      const Vector3f next = trial % 11 == 5 ? Vector3f::Zero() : motion_at(now, vertex);
      const float bound = change.at((vertex - change.point()).norm());
      EXPECT_LE((next - then).norm(), 1.0001F * bound + 1e-9F) << trial;
    }
  }
}

TEST(NearFieldChange, NothingMovesWhereNothingChanged) {
  const NearField field = near_field(Vec3::Zero(), Vec3::UnitZ(), 3e-3, Vec3(0.3, 0.0, 2.0));
  NearFieldChange change;
  change.set(&field, &field);
  EXPECT_EQ(change.at(0.0F), 0.0F);
}

}  // namespace
}  // namespace palpate::deform
