#include "run/palpation/insertion_score.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/contact/test/prepared_once.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"

namespace palpate::palpation {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A block whose upper side is z = 0 in its frame: skin 2 mm, fat 6 mm, space 5 mm, wall 0.4 mm, fluid.
scene::Scene block_scene() {
  scene::Scene scene;
  scene.task = scene::Task::kInsert;
  scene.organ = geometry::make_box(Vec3(80e-3, 80e-3, 60e-3), 8e-3);
  for (Vec3& vertex : scene.organ.vertices) vertex.z() -= 30e-3;
  scene.tissue = model::tissue_preset("liver");
  scene.tissue.layers = {{"skin", 2e-3}, {"fat", 6e-3}, {"space", 5e-3}, {"wall", 0.4e-3}, {"fluid"}};
  geometry::Tool tool;
  tool.parts.emplace_back().mesh = geometry::make_ball(1e-3);
  tool.needle = geometry::Needle{};  // its tip is the handle's origin
  scene.tools = {tool};
  scene.devices.resize(1);
  return scene;
}

scene::Scene with_target(const std::string& layer) {
  scene::Scene scene = block_scene();
  scene.target = {layer, {"wall"}};
  return scene;
}

scene::Scene with_nodule() {
  scene::Scene scene = block_scene();
  scene.inclusions = {{"seen", true, {Vec3(0.0, 0.0, -5e-3), 2e-3, 4.0}},
                      {"hidden", false, {Vec3(6e-3, 0.0, -20e-3), 5e-3, 4.0}}};
  return scene;
}

/// Rows of a needle that goes straight down at x = y = 0, one a millisecond, scored one by one.
class Needle final {
 public:
  explicit Needle(scene::Scene scene)
      : scene_(std::move(scene)),
        world_(scene::make_world(scene_, contact::test::prepared_once())),
        scorer_(scene_, world_.contact) {}

  /// The tip in the tissue. @param length of the shaft inside @param displaced u @param tilt of the needle
  void inside(double length_mm, std::uint64_t layer, double displaced_mm = 0.0, double tilt = 0.0) {
    const Vec3 inwards(std::sin(tilt), 0.0, -std::cos(tilt));
    const double way = (length_mm + displaced_mm) * kMillimetre;
    haptics::TickRow row = row_at(way * inwards, contact::Phase::kInsert);
    row.distance = -way;
    row.inserted_mm = length_mm;
    row.layer = layer;
    put(-inwards, row.normal);
    put(scene_.organ_pose.position, row.contact);
    row.tissue_force = 3.0 + length_mm / 10.0;
    scorer_.add(row);
  }
  void presses(double depth_mm) {
    haptics::TickRow row = row_at(Vec3(0.0, 0.0, -depth_mm * kMillimetre), contact::Phase::kPress);
    row.tissue_force = 4.5;
    scorer_.add(row);
  }
  void above(double height_mm) {
    scorer_.add(row_at(Vec3(0.0, 0.0, height_mm * kMillimetre), contact::Phase::kApproach));
  }
  [[nodiscard]] InsertionScore score() const { return scorer_.score(); }

 private:
  static void put(const Vec3& from, std::array<double, 3>& to) { to = {from.x(), from.y(), from.z()}; }
  haptics::TickRow row_at(const Vec3& tip_S, contact::Phase phase) {
    haptics::TickRow row;
    row.tick = tick_++;
    row.time = static_cast<double>(row.tick) / scene_.rate_Hz;
    row.phase = static_cast<std::uint32_t>(phase);
    row.tool_q = {0.0, 1.0, 0.0, 0.0};
    put(scene_.organ_pose * tip_S, row.tool);
    return row;
  }

  scene::Scene scene_;
  haptics::SimulationWorld world_;
  InsertionScorer scorer_;
  std::uint64_t tick_ = 0;
};

TEST(InsertionScore, NamesTheLayersAlsoOneThatTheTipCrossesWithinATick) {
  Needle needle(with_target("space"));
  needle.inside(0.1, 1);
  needle.inside(3.0, 2);
  needle.inside(9.0, 3);
  EXPECT_THAT(needle.score().crossed, ElementsAre("skin", "fat", "space"));
  EXPECT_THAT(needle.score().forbidden, IsEmpty());
  needle.inside(13.9, 5);  // through the wall
  EXPECT_THAT(needle.score().crossed, ElementsAre("skin", "fat", "space", "wall", "fluid"));
  EXPECT_THAT(needle.score().forbidden, ElementsAre("wall"));
  for (std::uint64_t layer = 4; layer > 0; --layer) needle.inside(1.0, layer);
  needle.inside(13.1, 4);
  EXPECT_EQ(needle.score().crossed.size(), 5U) << "none twice";
}

// The space begins 8 mm below the surface.
TEST(InsertionScore, ATipAtTheTargetsMembraneIsNotInTheTarget) {
  Needle needle(with_target("space"));
  needle.inside(0.1, 1);
  needle.inside(6.5, 2);
  EXPECT_NEAR(needle.score().closest.value(), 1.5e-3, 1e-12);
  needle.inside(8.0, 2, 2.0);
  EXPECT_NEAR(needle.score().closest.value(), 0.0, 1e-12);
  EXPECT_EQ(needle.score().reached, 0U);
  EXPECT_FALSE(needle.score().overshoot);
  needle.above(10.0);
  const InsertionScore score = needle.score();
  EXPECT_NEAR(score.at_end.value(), 18e-3, 1e-12);
  EXPECT_EQ(score.targets, 1U);
}

TEST(InsertionScore, ATipBeyondTheTargetIsAsFarAsTheLayersEnd) {
  Needle needle(with_target("fat"));
  needle.inside(0.1, 1);
  needle.inside(4.0, 2);
  needle.inside(10.5, 3);
  EXPECT_EQ(needle.score().closest.value(), 0.0);
  EXPECT_NEAR(needle.score().at_end.value(), 2.5e-3, 1e-12);
}

// The nodule's centre is 6 mm aside and 20 mm deep, its radius 5 mm. Tissue that is displaced by 4 mm has the
// tip at L below the surface, not at L + 4 mm.
TEST(InsertionScore, TheDistanceToAHiddenInclusionIsThatInTheTissueAtRest) {
  Needle needle(with_nodule());
  needle.presses(4.0);
  EXPECT_NEAR(needle.score().closest.value(), std::hypot(6.0, 20.0) * 1e-3 - 5e-3, 1e-9) << "on the surface";
  needle.inside(0.0, 1, 4.0);
  needle.inside(12.0, 3, 4.0);
  const InsertionScore score = needle.score();
  EXPECT_NEAR(score.closest.value(), 5e-3, 1e-9);  // hypot(6, 8) - 5
  EXPECT_EQ(score.targets, 1U) << "the visible one is none";
  EXPECT_EQ(score.reached, 0U);
}

TEST(InsertionScore, AnInclusionIsReachedWhereTheTipIsInIt) {
  scene::Scene scene = with_nodule();
  scene.inclusions[1].inclusion.centre_S.x() = 3e-3;  // 3 mm aside: its chord is from 16 to 24 mm
  scene.organ_pose.position = Vec3(0.1, -0.2, 0.3);
  Needle needle(std::move(scene));
  needle.inside(0.0, 1, 4.0);
  needle.inside(15.9, 5, 4.0);
  EXPECT_EQ(needle.score().reached, 0U);
  EXPECT_NEAR(needle.score().closest.value(), std::hypot(3.0, 4.1) * 1e-3 - 5e-3, 1e-9);
  needle.inside(16.1, 5, 3.0);
  EXPECT_EQ(needle.score().reached, 1U);
  EXPECT_EQ(needle.score().closest.value(), 0.0);
}

// From 8.1 mm, where the tip is first in the space, to 10.4 mm; then it rests for 0.3 s and goes on.
TEST(InsertionScore, TheOvershootEndsWhereTheTipRests) {
  Needle needle(with_target("space"));
  needle.inside(0.1, 1);
  for (int i = 0; i <= 23; ++i) needle.inside(8.1 + 0.1 * i, 3, 2.0 - 0.05 * i);
  for (int i = 0; i < 300; ++i) needle.inside(10.4, 3);
  for (int i = 0; i < 20; ++i) needle.inside(10.4 + 0.1 * i, 3);
  EXPECT_NEAR(needle.score().overshoot.value(), 2.3e-3, 1e-9);
}

// 6 mm to the far side, which is 20 mm from the entry; then 10 mm outside and 2 mm in the tissue behind.
TEST(InsertionScore, TheOvershootIsTheWayThroughTheTissueAndNotBeyondItsFarSide) {
  Needle needle(with_target("fluid"));
  needle.inside(0.1, 1);
  for (int i = 0; i <= 60; ++i) needle.inside(14.0 + 0.1 * i, 5);
  for (int i = 1; i <= 100; ++i) needle.inside(20.0 + 0.1 * i, 0);
  EXPECT_NEAR(needle.score().overshoot.value(), 6e-3, 1e-9);
  for (int i = 1; i <= 20; ++i) needle.inside(30.0 + 0.1 * i, 5);
  EXPECT_NEAR(needle.score().overshoot.value(), 8e-3, 1e-9);
}

TEST(InsertionScore, ASlowTipHasNotStopped) {
  Needle needle(with_target("space"));
  needle.inside(0.1, 1);
  for (int i = 0; i <= 2000; ++i) needle.inside(8.1 + 1e-3 * i, 3);  // 1 mm/s
  EXPECT_NEAR(needle.score().overshoot.value(), 2e-3, 1e-9);
}

TEST(InsertionScore, CountsAttemptsWithTheAngleOfTheOneThatReachedTheTarget) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  Needle needle(with_target("space"));
  needle.presses(5.0);
  EXPECT_FALSE(needle.score().angle);
  needle.inside(0.1, 1, 0.0, 20.0 * kDegree);
  needle.inside(5.0, 2, 0.0, 20.0 * kDegree);
  EXPECT_NEAR(needle.score().angle.value(), 20.0 * kDegree, 1e-9);
  needle.above(3.0);
  needle.inside(0.1, 1, 0.0, 10.0 * kDegree);
  needle.inside(9.0, 3, 0.0, 10.0 * kDegree);
  needle.above(3.0);
  needle.inside(0.1, 1);
  const InsertionScore score = needle.score();
  EXPECT_EQ(score.attempts, 3U);
  EXPECT_NEAR(score.angle.value(), 10.0 * kDegree, 1e-9);
}

// Contact begins at tick 2 and the target is reached at tick 5, of ten.
TEST(InsertionScore, TheTimeIsFromTheFirstContactToTheTarget) {
  Needle needle(with_target("space"));
  needle.above(2.0);
  needle.above(1.0);
  needle.presses(3.0);
  needle.inside(0.1, 1);
  needle.inside(7.0, 2);
  EXPECT_NEAR(needle.score().time, 2e-3, 1e-12) << "so far to the last contact";
  needle.inside(9.0, 3);
  needle.inside(9.0, 3);
  needle.inside(12.0, 3);
  needle.above(1.0);
  const InsertionScore score = needle.score();
  EXPECT_NEAR(score.time, 3e-3, 1e-12);
  EXPECT_NEAR(score.largest_force, 4.5, 1e-12) << "of the press; 4.2 N inside";
}

TEST(InsertionScore, WithoutATargetTheOtherMeasuresAreThere) {
  Needle needle(block_scene());
  needle.inside(0.1, 1);
  const auto json = nlohmann::json::parse(to_json(needle.score()));
  EXPECT_EQ(json["targets"], 0);
  EXPECT_TRUE(json["closest_mm"].is_null());
  EXPECT_TRUE(json["overshoot_mm"].is_null());
  EXPECT_EQ(json["crossed"], nlohmann::json({"skin"}));
  EXPECT_EQ(json["attempts"], 1);
  EXPECT_NEAR(json["angle_deg"].get<double>(), 0.0, 1e-6);
}

TEST(InsertionScore, RefusesATargetThatTheTissueDoesNotHave) {
  EXPECT_THAT([] { Needle needle(with_target("bone")); },
              testing::ThrowsMessage<InputError>("target: the tissue has no layer \"bone\""));
}

}  // namespace
}  // namespace palpate::palpation
