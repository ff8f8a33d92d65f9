#include "view/render/tool_imprint.h"

#include <cmath>

#include <gtest/gtest.h>

#include "palpate/mesh.h"

namespace palpate::render {
namespace {

constexpr double kRadius = 0.003;
constexpr double kDepth = 0.008;

// Lowering of a point: on the plane at rest, or displaced above it.
double lowering(const ToolImprint& imprint, const Vec3& now, const Vec3& rest, const Vec3& normal) {
  return static_cast<double>(imprint.lowering(now.cast<float>(), rest.cast<float>(), normal.cast<float>()));
}

std::vector<Vec3> corners_of(const geometry::TriangleMesh& mesh, const Vec3& offset) {
  std::vector<Vec3> corners;
  for (const geometry::Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) corners.emplace_back(mesh.vertices[static_cast<std::size_t>(v)] + offset);
  return corners;
}

// Imprint of a ball pressed kDepth into the plane z = 0.
ToolImprint ball_imprint() {
  return {corners_of(geometry::make_ball(kRadius, 20480), Vec3(0, 0, kRadius - kDepth)), Vec3::Zero(),
          -Vec3::UnitZ(), kDepth};
}

TEST(ToolImprint, LowersTheSurfaceOntoABarToHalfAMillimetre) {
  // 2 mm of its height lie below the surface.
  const std::vector<Vec3> bar = corners_of(geometry::make_box(Vec3(0.02, 0.006, 0.004), 0.001), Vec3::Zero());
  const ToolImprint imprint(bar, Vec3::Zero(), -Vec3::UnitZ(), 0.002);
  for (const double x : {-0.006, 0.0, 0.0033}) {
    const Vec3 rest(x, 0.0, 0.0);
    const double lowered = lowering(imprint, rest, rest, Vec3::UnitZ());
    EXPECT_NEAR(lowered, 0.002 * 0.002 / (0.002 + 0.0005), 2e-5) << x;
  }
}

TEST(ToolImprint, NeverLowersBelowTheTool) {
  const ToolImprint imprint = ball_imprint();
  for (int i = 0; i < 24; ++i) {
    const double x = 0.0001 * i;
    const double ball = kDepth - kRadius + std::sqrt(kRadius * kRadius - x * x);
    EXPECT_LT(lowering(imprint, Vec3(x, 0, 0), Vec3(x, 0, 0), Vec3::UnitZ()), ball + 1e-4) << x;
  }
}

TEST(ToolImprint, LeavesWhatIsBelowTheTool) {
  const ToolImprint imprint = ball_imprint();
  EXPECT_EQ(lowering(imprint, Vec3(0, 0, -kDepth), Vec3::Zero(), Vec3::UnitZ()), 0.0);
  EXPECT_EQ(lowering(imprint, Vec3(0.001, 0, -0.0079), Vec3(0.001, 0, 0), Vec3::UnitZ()), 0.0);
}

TEST(ToolImprint, NeverLowersByMoreThanTheDepthInAll) {
  const ToolImprint imprint = ball_imprint();
  // A vertex that was 5 mm above the contact, and one that is already lowered by 6 mm.
  const Vec3 high(0, 0, 0.005);
  EXPECT_LE(lowering(imprint, high, high, Vec3::UnitZ()), kDepth);
  EXPECT_LE(lowering(imprint, Vec3(0, 0, -0.001), high, Vec3::UnitZ()), kDepth - 0.006);
}

TEST(ToolImprint, FallsOffBesideTheToolByItsSlope) {
  const ToolImprint imprint = ball_imprint();
  const auto at = [&](double x) { return lowering(imprint, Vec3(x, 0, 0), Vec3(x, 0, 0), Vec3::UnitZ()); };
  EXPECT_NEAR((at(0.0040) - at(0.0045)) / 0.0005, 2.5, 0.15);
  EXPECT_EQ(at(0.0100), 0.0);
}

TEST(ToolImprint, LeavesASurfaceThatFacesAway) {
  const ToolImprint imprint = ball_imprint();
  EXPECT_EQ(lowering(imprint, Vec3::Zero(), Vec3::Zero(), -Vec3::UnitZ()), 0.0);
  EXPECT_EQ(lowering(imprint, Vec3::Zero(), Vec3::Zero(), Vec3::UnitX()), 0.0);
}

TEST(ToolImprint, LeavesWhatIsFarFromTheContact) {
  // A bar of 100 mm length, pressed 2 mm deep.
  const std::vector<Vec3> bar = corners_of(geometry::make_box(Vec3(0.1, 0.004, 0.004), 0.05), Vec3::Zero());
  const ToolImprint imprint(bar, Vec3::Zero(), -Vec3::UnitZ(), 0.002);
  EXPECT_GT(lowering(imprint, Vec3(0.01, 0, 0), Vec3(0.01, 0, 0), Vec3::UnitZ()), 0.0014);
  EXPECT_EQ(lowering(imprint, Vec3(0.0175, 0, 0), Vec3(0.0175, 0, 0), Vec3::UnitZ()), 0.0);
}

TEST(ToolImprint, ThereIsOneForEachPressAndNoneForAPull) {
  geometry::Tool tool;
  tool.parts.push_back({});
  tool.parts[0].mesh = geometry::make_ball(kRadius, 80);
  const std::vector<ToolShape> shapes(1, ToolShape(tool));
  haptics::Snapshot snapshot;
  EXPECT_TRUE(imprints_of(snapshot, shapes).empty());
  snapshot.hands = 1;
  snapshot.results[0].view_count = 2;
  for (const std::size_t i : {0U, 1U}) {
    snapshot.results[0].views[i].direction_S = -Vec3::UnitZ();
    snapshot.results[0].views[i].depth = 0.002;
  }
  snapshot.results[0].views[1].pull = true;
  EXPECT_EQ(imprints_of(snapshot, shapes).size(), 1U);
  EXPECT_TRUE(imprints_of(snapshot, {}).empty());
}

}  // namespace
}  // namespace palpate::render
