#include "core/contact/largest_stiffness.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/state.h"
#include "core/contact/test/rig.h"
#include "palpate/error.h"

namespace palpate::contact::test {
namespace {

constexpr double kTipBall = 5e-3;     // m
constexpr double kLoopPeriod = 1e-3;  // s
const Vec3 kHalfBlock(30e-3, 30e-3, 15e-3);
const StiffnessReach kWithinReach{model::Direction::kPress, 20.0, 15e-3};

/// A tissue of constant stiffness to 30 mm.
model::TissueParameters linear_tissue(double stiffness) {
  model::TissueParameters tissue = plain_tissue();
  tissue.k1 = stiffness;
  tissue.rest_length = 50e-3;
  tissue.min_length = 20e-3;
  tissue.max_length = 80e-3;
  return tissue;
}

model::Inclusion hard_stone() {
  model::Inclusion made;
  made.centre_S = Vec3(0.0, 0.0, 15e-3 - 5.1e-3);
  made.radius = 5e-3;
  made.ratio = 100.0;
  return made;
}

World world_of(const model::TissueParameters& tissue, const model::TissueVariation& variation = {}) {
  geometry::Tool ball = one_part_tool(geometry::make_ball(kTipBall, 320));
  ball.tip_radius = kTipBall;
  return World(geometry::make_box(2.0 * kHalfBlock, 5e-3), {ball}, tissue, kLoopPeriod, prepared_once(),
               variation);
}

double stiffness_of(const World& world) {
  return largest_stiffness(world, world.data().laws, world.inclusions(), 0, kWithinReach);
}

TEST(LargestStiffness, OfUniformTissueIsItsLargestTangent) {
  EXPECT_DOUBLE_EQ(stiffness_of(world_of(linear_tissue(300.0))), 300.0);
  const model::TissueParameters gallbladder = model::tissue_preset("gallbladder");
  const TissueLaws laws(gallbladder, kLoopPeriod);
  // 15 mm lies in the third layer: 8 mm, 5.6 mm, 3.92 mm; 16 x 18 N/m x e^(2/1.6).
  EXPECT_NEAR(largest_tangent(laws.press, kWithinReach), 16.0 * 18.0 * std::exp(2.0 / 1.6), 1e-9);
}

TEST(LargestStiffness, ForceBeyondTheGateIsNotWithinReach) {
  const TissueLaws laws(model::tissue_preset("gallbladder"), kLoopPeriod);
  EXPECT_NEAR(largest_tangent(laws.press, {model::Direction::kPress, 0.1, 15e-3}), 18.0, 1e-9);
}

TEST(LargestStiffness, StonesAtOnePlaceAreStifferThanOneAndBounded) {
  const auto with_stones = [](std::size_t count) {
    model::TissueVariation variation;
    variation.inclusions.assign(count, hard_stone());
    return stiffness_of(world_of(linear_tissue(100.0), variation));
  };
  const double one = with_stones(1);
  const double three = with_stones(3);
  EXPECT_GT(one, 300.0);
  EXPECT_GT(three, 1.5 * one);
  EXPECT_LT(with_stones(8), 150.0 * 100.0) << "without the cap of the product it would be above 10,000 times";
}

// The energy on the axis by hand, without the module's own quotient.
TEST(LargestStiffness, IsAtLeastTheSecondDerivativeOfTheEnergyOverAStone) {
  const model::InclusionLaw law(5e-3, 5.1e-3, 100.0);
  const auto energy = [&](double depth) {
    return 0.5 * 100.0 * depth * depth * (1.0 + law.at(model::PressedTip(kTipBall, depth), 0.0).energy);
  };
  constexpr double kStep = 1e-5;
  double by_hand = 0.0;
  for (double depth = 1e-3; depth < 14e-3; depth += 0.1e-3) {
    by_hand = std::max(
        by_hand, (energy(depth + kStep) - 2.0 * energy(depth) + energy(depth - kStep)) / (kStep * kStep));
  }
  EXPECT_GT(stiffness_of(world_of(linear_tissue(100.0), {{hard_stone()}, {}})), 0.95 * by_hand);
}

TEST(LargestStiffness, DoesNotDependOnTheAxesOfTheTangentPlane) {
  const auto two_stones = [](double angle) {
    model::TissueVariation variation;
    for (const double x : {-3e-3, 3e-3}) {
      model::Inclusion stone = hard_stone();
      stone.centre_S += Vec3(x * std::cos(angle), x * std::sin(angle), 0.0);
      variation.inclusions.push_back(stone);
    }
    return stiffness_of(world_of(linear_tissue(100.0), variation));
  };
  const double along_x = two_stones(0.0);
  for (const double angle : {0.4, 0.785, 1.2})
    EXPECT_NEAR(two_stones(angle), along_x, 0.02 * along_x) << angle;
}

TEST(LargestStiffness, ThePeakOfAStiffnessMapIsStiffSideways) {
  model::TissueVariation variation;
  variation.stiffness.push_back({Vec3(0.0, 0.0, 15e-3), 1.0});
  for (int i = 0; i < 12; ++i) {
    const double angle = i * 3.14159265358979323846 / 6.0;
    variation.stiffness.push_back({Vec3(3e-3 * std::cos(angle), 3e-3 * std::sin(angle), 15e-3), 0.01});
  }
  // k falls by 1 within 3 mm: d2k/dc2 is about 2 / (3 mm)^2, times the energy of 15 mm.
  const double about = 2.0 / 9e-6 * 0.5 * 300.0 * 15e-3 * 15e-3;
  const double found = stiffness_of(world_of(linear_tissue(300.0), variation));
  EXPECT_GT(found, 0.5 * about);
  EXPECT_LT(found, 5.0 * about);
}

TEST(LargestStiffness, AnInclusionOutsideTheOrganIsRefused) {
  const World world = world_of(linear_tissue(100.0), {{hard_stone()}, {}});
  model::Inclusion outside = hard_stone();
  outside.centre_S.z() = 0.1;
  EXPECT_THROW((void)largest_stiffness(world, world.data().laws, {outside}, 0, kWithinReach), InputError);
}

TEST(LargestStiffness, ALayerTooStiffForDoublesIsRefused) {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.beta = 0.02;
  EXPECT_THROW(TissueLaws(tissue, kLoopPeriod), ParameterError);
  tissue.beta = 0.1;
  EXPECT_NO_THROW(TissueLaws(tissue, kLoopPeriod));
}

TEST(LargestStiffness, ASecondLayerTooStiffForANumberIsRefusedAlthoughItsLawHasOneLayer) {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.max_depth.reset();
  tissue.beta = 1e-3;  // e^1000 is no double; the first layer ends at 18 N/m x 8 mm = 0.144 N
  EXPECT_THROW(TissueLaws(tissue, kLoopPeriod), ParameterError);
}

TEST(LargestStiffness, ASmoothLawThatReachesAForceOfNoTissueIsRefused) {
  model::TissueParameters tissue = model::tissue_preset("liver");
  tissue.max_depth.reset();
  tissue.beta = 0.01;  // six layers: e^500 times as stiff at the end
  EXPECT_THROW(TissueLaws(tissue, kLoopPeriod), ParameterError);
  tissue.beta = 0.2;  // the softest that a fit looks for
  EXPECT_NO_THROW(TissueLaws(tissue, kLoopPeriod));
}

}  // namespace
}  // namespace palpate::contact::test
