#include "run/palpation/score.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/contact/test/prepared_once.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"

namespace palpate::palpation {
namespace {

constexpr double kRadius = 5e-3;  // of the tool [m]
constexpr double kHalf = 40e-3;   // of the box's side [m]

/// A box whose upper side is z = 0, with two hidden nodules.
scene::Scene box_scene() {
  scene::Scene scene;
  scene.task = scene::Task::kPalpate;
  scene.organ = geometry::make_box(Vec3(2.0 * kHalf, 2.0 * kHalf, 40e-3), 4e-3);
  for (Vec3& vertex : scene.organ.vertices) vertex.z() -= 20e-3;
  scene.tissue = model::tissue_preset("liver");
  geometry::Tool tool;
  tool.parts.emplace_back().mesh = geometry::make_ball(kRadius);
  tool.tip_radius = kRadius;
  scene.tools = {tool};
  scene.devices.resize(1);
  for (const double x : {-20e-3, 20e-3}) {
    scene.inclusions.push_back({x < 0.0 ? "left" : "right", false, {Vec3(x, 0.0, -10e-3), 5e-3, 10.0}});
  }
  return scene;
}

/// Rows of one hand in contact with the upper side.
class Rows final {
 public:
  explicit Rows(const scene::Scene& scene) { made_.scene = scene; }

  void touch(double x, double y, double force, std::uint32_t buttons = 0, double depth = 5e-3) {
    haptics::TickRow row;
    row.tick = made_.rows.size();
    row.time = static_cast<double>(row.tick) / made_.scene.rate_Hz;
    row.phase = static_cast<std::uint32_t>(contact::Phase::kPress);
    row.depth = depth;
    row.tissue_force = force;
    row.contact = {x, y, 0.0};
    row.normal = {0.0, 0.0, 1.0};
    row.tool = {x, y, 0.0};
    row.buttons = buttons;
    made_.rows.push_back(row);
  }
  void lift(std::uint32_t buttons = 0) {
    touch(0.0, 0.0, 0.0, buttons);
    made_.rows.back().phase = static_cast<std::uint32_t>(contact::Phase::kApproach);
    made_.rows.back().depth = 0.0;
  }
  [[nodiscard]] const record::Recording& recording() const { return made_; }

 private:
  record::Recording made_;
};

Score score_of(const Rows& rows) {
  return ScoredRecording(rows.recording(), contact::test::prepared_once()).scorer().score();
}

TEST(PalpationScore, NeedsASearch) {
  scene::Scene scene = box_scene();
  require_search(scene, "a.h5", "search");
  scene.task = scene::Task::kPress;
  require_search(scene, "a.h5", "search");  // its inclusions can be found
  scene.inclusions.clear();
  EXPECT_THAT([&] { require_search(scene, "a.h5", "search"); },
              testing::ThrowsMessage<InputError>(
                  "a.h5: no search in it: its task is press and it has no lump; search"));
}

// The tolerance is 10 mm. Marks: 6 mm beside the left nodule; a second one there, 3 mm beside; 15 mm beside
// the right nodule.
TEST(PalpationScore, CountsFoundMissedFalseAndRepeatedMarks) {
  Rows rows(box_scene());
  for (const auto& [x, y] : {std::pair(-20e-3, 6e-3), std::pair(-17e-3, 0.0), std::pair(20e-3, 15e-3)}) {
    rows.touch(x, y, 0.1);
    rows.touch(x, y, 0.1, 1);
    rows.touch(x, y, 0.1, 1);  // the button is held
    rows.touch(x, y, 0.1);
  }
  const Score score = score_of(rows);
  EXPECT_EQ(score.found, 1U);
  EXPECT_EQ(score.missed, 1U);
  EXPECT_EQ(score.wrong, 1U);
  EXPECT_EQ(score.repeated, 1U);
  ASSERT_EQ(score.marks.size(), 3U);
  EXPECT_NEAR(score.marks[0].distance, 6e-3, 1e-9);
  EXPECT_NEAR(score.error.value(), 6e-3, 1e-9);
  EXPECT_NEAR(score.marks[2].distance, 15e-3, 1e-9);
  EXPECT_TRUE(score.lumps[0].found);
  EXPECT_FALSE(score.lumps[1].covered);
  EXPECT_DOUBLE_EQ(score.time, 9e-3);  // from tick 0 to the third mark at tick 9
}

TEST(PalpationScore, AMarkNeedsContact) {
  Rows rows(box_scene());
  rows.touch(-20e-3, 0.0, 0.1);
  rows.lift();
  rows.lift(1);
  rows.touch(-20e-3, 0.0, 0.1, 1);  // the button was pressed before the contact
  const Score score = score_of(rows);
  EXPECT_TRUE(score.marks.empty());
  EXPECT_EQ(score.wrong, 0U);
  EXPECT_EQ(score.untouched, 1U);
  EXPECT_DOUBLE_EQ(score.time, 3e-3);  // to the last contact, because nothing is marked
}

TEST(PalpationScore, AnotherButtonMarksNothing) {
  scene::Scene scene = box_scene();
  scene.search.mark_button = 3;
  Rows rows(scene);
  rows.touch(-20e-3, 0.0, 0.1, 1);
  rows.touch(-20e-3, 0.0, 0.1, 8);
  EXPECT_EQ(score_of(rows).marks.size(), 1U);
}

// F = 2 t + 0.1 N for 1 s: mean 1.1 N, largest 2.098 N, standard deviation 2/sqrt(12) N, rate 2 N/s.
TEST(PalpationScore, ForceMeasuresOfARamp) {
  Rows rows(box_scene());
  for (int i = 0; i < 1000; ++i) rows.touch(0.0, 0.0, 0.1 + 2e-3 * i);
  const Score score = score_of(rows);
  EXPECT_NEAR(score.mean_force, 1.099, 1e-9);
  EXPECT_NEAR(score.largest_force, 2.098, 1e-9);
  EXPECT_NEAR(score.force_variation, 2.0 / std::sqrt(12.0) / 1.099, 1e-5);
  EXPECT_NEAR(score.force_rate, 2.0, 1e-9);
  EXPECT_NEAR(score.contact_time, 1.0, 1e-9);
  EXPECT_EQ(score.found, 0U);
  EXPECT_FALSE(score.error);
}

TEST(PalpationScore, TheRateDoesNotReachOverALift) {
  Rows rows(box_scene());
  for (int i = 0; i < 100; ++i) rows.touch(0.0, 0.0, 0.1);
  rows.lift();
  for (int i = 0; i < 100; ++i) rows.touch(0.0, 0.0, 1.0);
  EXPECT_EQ(score_of(rows).force_rate, 0.0);
}

TEST(PalpationScore, ThePathIsTheToolsLength) {
  Rows rows(box_scene());
  for (int i = 0; i <= 30; ++i) rows.touch(-30e-3 + 1e-3 * i, 0.0, 0.1);
  EXPECT_NEAR(score_of(rows).path, 30e-3, 1e-12);
}

// One touch covers a disc of the tip's radius; the box's upper side is the search area.
TEST(PalpationScore, CoverageIsTheTouchedShareOfTheUpperSide) {
  Rows once(box_scene());
  once.touch(1e-3, 2e-3, 0.1);
  const double disc = std::numbers::pi * kRadius * kRadius / (4.0 * kHalf * kHalf);
  EXPECT_NEAR(score_of(once).coverage, disc, 0.1 * disc);
  Rows all(box_scene());
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) all.touch(4e-3 * i, 4e-3 * j, 0.1);
  }
  EXPECT_NEAR(score_of(all).coverage, 1.0, 1e-9);
}

TEST(PalpationScore, ASceneThatHidesNothingIsScoredForAllItsInclusions) {
  scene::Scene scene = box_scene();
  scene.inclusions[0].visible = true;
  EXPECT_EQ(lumps_of(scene).size(), 1U);
  scene.inclusions[1].visible = true;
  EXPECT_EQ(lumps_of(scene).size(), 2U);
}

TEST(FeltMap, IsTheFeltForceOverThatOfUniformTissue) {
  scene::Scene scene = box_scene();
  scene.inclusions.clear();
  scene.tissue.contact.damping = 2.0;
  const haptics::SimulationWorld world = scene::make_world(scene, contact::test::prepared_once());
  Rows rows(scene);
  // In and out at 20 mm/s with twice the uniform force, and the damping's 0.04 N.
  for (int i = -200; i < 200; ++i) {
    const double depth = 6e-3 - 20e-6 * std::abs(i);
    const double damping = i <= 0 ? 0.04 : -0.04;
    rows.touch(0.0, 0.0, 2.0 * world.contact.press_law().force_at(depth).force + damping, 0, depth);
  }
  const ScoredRecording scored(rows.recording());
  const Scorer& made = scored.scorer();
  int felt = 0;
  for (std::size_t v = 0; v < made.map().surface().vertices.size(); ++v) {
    const Vec3& place = made.map().surface().vertices[v];
    const FeltPlace one = made.map().at(v);
    // 399 ticks of known speed, of which 20 must count by their weight.
    const double share = 1.0 - place.head<2>().squaredNorm() / (kRadius * kRadius);
    const bool near = place.z() == 0.0 && share > 0.0 && 399.0 * share * share > 20.0;
    EXPECT_EQ(std::isnan(one.factor), !near);
    if (!near) continue;
    ++felt;
    EXPECT_NEAR(one.factor, 2.0, 0.02);
    EXPECT_NEAR(one.depth, 6e-3, 1e-6);
    EXPECT_DOUBLE_EQ(made.map().true_factor(v), 1.0);
  }
  EXPECT_GT(felt, 20);
}

TEST(FeltMap, TheTrueFactorRisesOverANoduleAndIsOneFarAway) {
  const scene::Scene scene = box_scene();
  const haptics::SimulationWorld world = scene::make_world(scene, contact::test::prepared_once());
  const FeltMap map(world.contact);
  double over = 0.0;
  for (std::size_t v = 0; v < map.surface().vertices.size(); ++v) {
    const Vec3& place = map.surface().vertices[v];
    if (place.z() != 0.0) continue;
    const double factor = map.true_factor(v);
    if ((place - Vec3(20e-3, 0.0, 0.0)).norm() < 1e-3) over = std::max(over, factor);
    EXPECT_LT(factor, std::abs(place.y()) > 38e-3 ? 1.01 : 10.0);
  }
  EXPECT_GT(over, 1.05);
}

}  // namespace
}  // namespace palpate::palpation
