#include "view/render/grasped_fold.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/builtin.h"
#include "palpate/mesh.h"
#include "palpate/tissue.h"
#include "view/render/organ_picture.h"

namespace palpate::render {
namespace {

geometry::TriangleMesh triangle(const Vec3& tip, double width, const Vec3& root) {
  return {{tip - Vec3(0, 0.5 * width, 0), tip + Vec3(0, 0.5 * width, 0), root}, {{0, 1, 2}}};
}

// Two flat jaws of 20 mm that turn about y by 0.2 rad each, with tips 4 mm wide.
geometry::Tool pliers() {
  geometry::Tool tool;
  tool.name = "pliers";
  for (const double side : {-1.0, 1.0}) {
    geometry::ToolPart jaw;
    jaw.name = side < 0 ? "left" : "right";
    jaw.mesh = triangle(Vec3::Zero(), 4e-3, Vec3(0, 0, 0.02));
    jaw.is_jaw = true;
    jaw.pivot = Vec3(0, 0, 0.02);
    jaw.axis = Vec3::UnitY();
    jaw.open_angle = 0.2 * side;
    tool.parts.push_back(jaw);
  }
  return tool;
}

haptics::Snapshot pull_by(double depth) {
  haptics::Snapshot snapshot{};
  snapshot.hands = 1;
  snapshot.results[0].view_count = 1;
  snapshot.results[0].views[0].pull = true;
  snapshot.results[0].views[0].depth = depth;
  snapshot.results[0].views[0].direction_S = Vec3::UnitZ();
  return snapshot;
}

TEST(GraspedFold, TheSlopeIsTheGradientOfTheRaise) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-3e-3F, 3e-3F);
  const Vec3 up = Vec3(0.3, -0.2, 0.9).normalized();
  const GraspedFold fold(Vec3(0.01, 0.02, 0.03), up, up.unitOrthogonal(), 4e-3, 3e-3, 5e-3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f at =
        Eigen::Vector3f(0.01F, 0.02F, 0.03F) + Eigen::Vector3f(any(random), any(random), any(random));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f step = 2e-5F * Eigen::Vector3f::Unit(k);
      const float difference = (fold.raise(at + step).by - fold.raise(at - step).by) / 4e-5F;
      EXPECT_NEAR(fold.raise(at).slope[k], difference, 0.02F);
    }
  }
}

TEST(GraspedFold, TheRidgeRunsAcrossTheOpeningAndIsHighestAtThePeak) {
  const GraspedFold fold(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitX(), 4e-3, 3e-3, 6e-3);
  EXPECT_FLOAT_EQ(fold.raise(Eigen::Vector3f::Zero()).by, 4e-3F);
  EXPECT_GT(fold.raise({0.0F, 2e-3F, 0.0F}).by, 3e-3F);    // along the jaws' width
  EXPECT_LT(fold.raise({2.5e-3F, 0.0F, 0.0F}).by, 5e-4F);  // under a jaw
  EXPECT_LT(fold.raise({0.0F, 6e-3F, 0.0F}).by, 1e-5F);
}

// Smallest distance between the tips of the two jaws [m].
double gap(const geometry::Tool& tool, double gripper) {
  const Vec3 left = geometry::part_pose(tool.parts[0], gripper) * Vec3(Vec3::Zero());
  const Vec3 right = geometry::part_pose(tool.parts[1], gripper) * Vec3(Vec3::Zero());
  return (left - right).norm();
}

TEST(GraspedFold, HoldingJawsAreDrawnOpenByTheFold) {
  const geometry::Tool tool = pliers();
  const std::optional<Jaws> jaws = Jaws::of(tool);
  ASSERT_TRUE(jaws);
  const double shown = drawn_gripper(pull_by(10e-3), 0, &*jaws);
  EXPECT_NEAR(gap(tool, shown), 3e-3, 0.05e-3);
  haptics::Snapshot wide = pull_by(10e-3);
  wide.tools[0].gripper = 0.9;
  EXPECT_EQ(drawn_gripper(wide, 0, &*jaws), 0.9) << "an opening that is there stays";
}

TEST(GraspedFold, WithoutAPullNothingChanges) {
  const std::optional<Jaws> jaws = Jaws::of(pliers());
  ASSERT_TRUE(jaws);
  haptics::Snapshot press = pull_by(10e-3);
  press.results[0].views[0].pull = false;
  EXPECT_EQ(drawn_gripper(press, 0, &*jaws), 0.0);
  EXPECT_TRUE(folds_of(press, std::vector{jaws}).empty());
  EXPECT_EQ(drawn_gripper(pull_by(10e-3), 0, nullptr), 0.0);
}

TEST(GraspedFold, GrowsFromNothingAtTheGrasp) {
  const std::vector<std::optional<Jaws>> jaws = {Jaws::of(pliers())};
  double before = 0.0;
  for (double depth = 0.02e-3; depth < 6e-3; depth += 0.02e-3) {
    const haptics::Snapshot snapshot = pull_by(depth);
    const std::vector<GraspedFold> folds = folds_of(snapshot, jaws);
    ASSERT_EQ(folds.size(), 1U);
    EXPECT_NEAR((folds[0].peak() - Vec3(0, 0, depth)).norm(), 0.0, 1e-12);
    const double height = static_cast<double>(folds[0].raise(folds[0].peak().cast<float>()).by);
    EXPECT_NEAR(height, before, 0.05e-3) << "at " << depth;
    before = height;
  }
  EXPECT_NEAR(before, 4e-3, 1e-6);
}

TEST(GraspedFold, RaisesTheDrawnSurfaceWithoutCountingAsDisplacement) {
  OrganPicture organ(geometry::make_ball(30e-3, 5120), model::tissue_preset("heart").reach);
  const std::vector<deform::Indentation> pull = {{Vec3(0, 0, 30e-3), Vec3::UnitZ(), 8e-3, 2e-3, 0.0}};
  const auto highest = [&organ] {
    deform::SurfaceVertex most{};
    for (const deform::SurfaceVertex& vertex : organ.vertices()) {
      most.position.z() = std::max(most.position.z(), vertex.position.z());
      most.moved = std::max(most.moved, std::abs(vertex.moved));
    }
    return most;
  };
  organ.update(pull);
  const deform::SurfaceVertex plain = highest();
  const std::vector<GraspedFold> folds = {
      GraspedFold(Vec3(0, 0, 38e-3), Vec3::UnitZ(), Vec3::UnitX(), 4e-3, 3e-3, 5e-3)};
  organ.update(pull, {}, folds);
  const deform::SurfaceVertex folded = highest();
  EXPECT_NEAR(folded.position.z() - plain.position.z(), 4e-3F, 0.3e-3F);
  EXPECT_EQ(folded.moved, plain.moved);
}

TEST(GraspedFold, BuiltInForcepsHoldAndABallDoesNot) {
  for (const char* name : {"straight-forceps", "curved-forceps"})
    EXPECT_TRUE(Jaws::of(geometry::make_tool(name))) << name;
  geometry::Tool ball;
  ball.parts.emplace_back().mesh = geometry::make_ball(2e-3, 80);
  EXPECT_FALSE(Jaws::of(ball));
}

}  // namespace
}  // namespace palpate::render
