// Press: the law at the penetration depth, friction, edges, thin plates, starts of contacts.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"
#include "palpate/error.h"

namespace palpate::contact::test {
namespace {

const Vec3 kBox(60e-3, 60e-3, 40e-3);
constexpr double kSpeed = 10e-3;  // m/s

Quat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

double law(const Rig& rig, double depth) { return rig.world().press_law().force_at(depth).force; }

TEST(Press, BallGivesTheLawsForceAtItsDeepestPointWhateverTheTriangles) {
  std::mt19937 random(1);
  for (const double box_edge : {0.1, 6e-3}) {
    for (const int triangles : {80, 1280, 20480}) {
      const geometry::TriangleMesh ball =
          turned(geometry::make_ball(3e-3, triangles), random_rotation(random));
      Rig rig(block(kBox, box_edge), one_part_tool(ball), plain_tissue());
      const Vec3 over(1.3e-3, -0.7e-3, 0.0);
      rig.tick(place(over + Vec3(0, 0, 4e-3)));
      for (const double depth : {2e-3, 9e-3, 12e-3}) {
        rig.move_to(over + Vec3(0, 0, -depth - lowest_z(ball)), 40e-3);
        const ToolResult& result = rig.hold(0.1);
        EXPECT_NEAR(result.force_W.z() / law(rig, depth), 1.0, 0.01)
            << triangles << " triangles at " << depth;
        EXPECT_LT(result.force_W.head<2>().norm(), 0.01 * law(rig, depth));
        EXPECT_EQ(result.phase, Phase::kPress);
        EXPECT_NEAR(result.depth, depth, 3e-6);  // the finest ball has only a part of its points sampled
      }
    }
  }
}

TEST(Press, TorqueIsTheLeverFromTheToolsOriginTimesTheForce) {
  geometry::TriangleMesh ball = moved(geometry::make_ball(3e-3, 1280), Vec3(20e-3, 5e-3, 0));
  Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
  rig.tick(place(Vec3(-20e-3, -5e-3, 8e-3)));
  rig.move_to(Vec3(-20e-3, -5e-3, -2e-3), kSpeed);
  const ToolResult& result = rig.hold(0.1);
  const double force = result.force_W.z();
  ASSERT_GT(force, 0.0);
  EXPECT_NEAR(result.torque_W.x(), 5e-3 * force, 1e-4 * force);  // r x F = (y F, -x F, 0)
  EXPECT_NEAR(result.torque_W.y(), -20e-3 * force, 1e-4 * force);
  EXPECT_NEAR(result.torque_W.z(), 0.0, 1e-6 * force);
}

TEST(Press, SlidBallFeelsMuTimesTheNormalForceAndTheNormalForceStays) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 0.3;
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), tissue);
  const double z = -5e-3 - lowest_z(ball);
  rig.tick(place(Vec3(-10e-3, 3e-3, 5e-3)));
  rig.move_to(Vec3(-10e-3, 3e-3, z), kSpeed);
  const double normal_before = rig.hold(0.2).force_W.z();
  const ToolResult& result = rig.move_to(Vec3(10e-3, 3e-3, z), 20e-3);
  EXPECT_NEAR(result.force_W.z(), normal_before, 1e-3 * normal_before);
  EXPECT_NEAR(-result.force_W.x() / result.force_W.z(), 0.3, 0.02 * 0.3);
  EXPECT_NEAR(result.friction, 0.3 * result.force_W.z(), 0.02 * 0.3 * result.force_W.z());
}

TEST(Press, StickingFrictionGivesBackNoMoreWorkThanWasPutIn) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 0.5;
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), tissue);
  const double z = -6e-3 - lowest_z(ball);
  rig.tick(place(Vec3(0, 0, 5e-3)));
  rig.move_to(Vec3(0, 0, z), kSpeed);
  rig.hold(0.1);
  double work_by_hand = 0.0;
  Vec3 last = rig.pose().position;
  for (int i = 1; i <= 4000; ++i) {
    const double x = 1e-3 * std::sin(2e-3 * i);
    const Vec3 now(x, 0.5 * x, z);
    const Vec3 force = rig.tick(place(now)).force_W;
    work_by_hand -= force.dot(now - last);
    last = now;
    EXPECT_GE(work_by_hand, -1e-9);
  }
}

/// A ball 6 mm deep in a block, held still.
Rig pressed_ball(const model::TissueParameters& tissue) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), tissue);
  rig.tick(place(Vec3(0, 0, 5e-3)));
  rig.move_to(Vec3(0, 0, -6e-3 - lowest_z(ball)), kSpeed);
  rig.hold(0.1);
  return rig;
}

TEST(Press, AStuckContactMovedAlongTheSurfaceFeelsItsTangentialDampingTimesTheSpeed) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 5.0;  // no slip
  Rig without = pressed_ball(tissue);
  tissue.contact.tangential_damping = 2.0;
  Rig with = pressed_ball(tissue);
  const Vec3 goal = with.pose().position + Vec3(0.4e-3, 0.3e-3, 0.0);
  with.move_to(goal, 10e-3);
  without.move_to(goal, 10e-3);
  const Vec3 more = with.result().force_W - without.result().force_W;
  EXPECT_NEAR(more.x(), -2.0 * 10e-3 * 0.8, 1e-9) << "c_t v, against the motion";
  EXPECT_NEAR(more.y(), -2.0 * 10e-3 * 0.6, 1e-9);
  EXPECT_NEAR(more.z(), 0.0, 1e-9);
  EXPECT_NEAR((with.hold(0.01).force_W - without.hold(0.01).force_W).norm(), 0.0, 1e-9)
      << "at rest: the spring's";
}

TEST(Press, FrictionWithTangentialDampingStaysWithinTheCone) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 0.3;
  tissue.contact.tangential_damping = 20.0;
  Rig rig = pressed_ball(tissue);
  const Vec3 from = rig.pose().position;
  rig.each_tick([](const ToolResult& result) {
    EXPECT_LE(result.force_W.head<2>().norm(), 0.3 * result.force_W.z() * (1.0 + 1e-9));
  });
  for (int i = 1; i <= 2000; ++i)
    rig.tick(place(from + Vec3(3e-3 * std::sin(0.02 * i), 1e-3 * std::sin(0.05 * i), 0)));
  rig.move_to(from + Vec3(8e-3, 0, 0), 50e-3);
  EXPECT_NEAR(-rig.result().force_W.x() / rig.result().force_W.z(), 0.3, 0.02 * 0.3) << "it slides";
}

TEST(Press, ASlidingContactFeelsTheConeWhateverItsTangentialDamping) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 0.2;
  Rig without = pressed_ball(tissue);
  tissue.contact.tangential_damping = 3.0;
  Rig with = pressed_ball(tissue);
  const Vec3 goal = with.pose().position + Vec3(8e-3, 0, 0);
  with.move_to(goal, 20e-3);
  without.move_to(goal, 20e-3);
  EXPECT_NEAR((with.result().force_W - without.result().force_W).norm(), 0.0, 1e-6);
}

TEST(Press, AClosedTangentialCycleWithDampingGivesBackNoWorkAndTakesMoreThanWithout) {
  double put_in[2] = {0.0, 0.0};
  for (const int damped : {0, 1}) {
    model::TissueParameters tissue = plain_tissue();
    tissue.contact.friction = 5.0;
    tissue.contact.tangential_damping = damped * 1.5;
    Rig rig = pressed_ball(tissue);
    const Vec3 from = rig.pose().position;
    Vec3 last = from;
    for (int i = 1; i <= 1000; ++i) {
      const double angle = 2.0 * M_PI * i / 1000.0;
      const Vec3 now = from + 0.3e-3 * Vec3(std::sin(angle), std::sin(2.0 * angle), 0.0);
      put_in[damped] -= rig.tick(place(now)).force_W.dot(now - last);
      last = now;
      EXPECT_GE(put_in[damped], -1e-12);
    }
  }
  // c_t times the integral of v^2; for amplitude A over 1 s: A^2 (2 pi)^2/2 (1 + 4).
  EXPECT_NEAR(put_in[1] - put_in[0], 1.5 * 0.3e-3 * 0.3e-3 * 2.0 * M_PI * M_PI * 5.0, 1e-3 * put_in[1]);
}

TEST(Press, AtRestIsExactlyStill) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = 0.2;
  tissue.contact.damping = 0.5;
  Rig rig(geometry::make_ball(25e-3, 1280), one_part_tool(geometry::make_ball(3e-3, 320)), tissue);
  rig.tick(place(Vec3(2e-3, 1e-3, 32e-3)));
  rig.move_to(Vec3(5e-3, -2e-3, 22e-3), 20e-3);
  rig.hold(0.5);
  const ToolResult still = rig.result();
  for (int i = 0; i < 1000; ++i) {
    const ToolResult& now = rig.tick(rig.pose());
    ASSERT_EQ(now.force_W, still.force_W);
    ASSERT_EQ(now.torque_W, still.torque_W);
    ASSERT_EQ(now.contact_W, still.contact_W);
  }
}

TEST(Press, RoundingDoesNotMakeATouchingToolComeAndGo) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
  rig.tick(place(Vec3(0, 0, 4e-3)));
  int changes = 0;
  Phase last = Phase::kApproach;
  for (int i = 0; i < 200; ++i) {
    const double rounding = 1e-17 * ((i % 3) - 1);
    const Phase now = rig.tick(place(Vec3(0, 0, -lowest_z(ball) + rounding))).phase;
    changes += now != last ? 1 : 0;
    last = now;
  }
  EXPECT_LE(changes, 1);
}

TEST(Press, IntoAThinPlateKeepsToItsOwnSide) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(Vec3(60e-3, 60e-3, 10e-3), 0.1), one_part_tool(ball), plain_tissue());
  rig.tick(place(Vec3(1e-3, 3e-3, 5e-3)));
  rig.move_to(Vec3(1e-3, 3e-3, -8e-3 - lowest_z(ball)), kSpeed);
  const ToolResult& result = rig.hold(0.2);
  EXPECT_NEAR(result.force_W.z(), law(rig, 8e-3), 0.01 * law(rig, 8e-3));
  EXPECT_GT(result.normal_W.z(), 0.999);
}

TEST(Press, OverEdgesAndCornersTheForceHasNoSteps) {
  struct Way {
    Vec3 from, to;
  };
  for (const Way& way :
       {Way{Vec3(20e-3, 0, 0), Vec3(36e-3, 0, 0)}, Way{Vec3(25e-3, 25e-3, 0), Vec3(35e-3, 35e-3, 0)},
        Way{Vec3(20e-3, 28.5e-3, 0), Vec3(36e-3, 28.5e-3, 0)}}) {
    for (const double depth : {2e-3, 5e-3}) {
      const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
      Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
      StepMeter meter;
      rig.each_tick([&](const ToolResult& result) { meter(result); });
      const Vec3 down(0, 0, -depth - lowest_z(ball));
      rig.tick(place(way.from + Vec3(0, 0, 5e-3)));
      rig.move_to(way.from + down, kSpeed);
      rig.move_to(way.to + down, 20e-3);
      EXPECT_GT(meter.peak_force(), 0.0);
      EXPECT_LT(meter.force_step(), 0.05) << "depth " << depth;
      EXPECT_LT(meter.torque_step(), 0.05) << "depth " << depth;
    }
  }
}

TEST(Press, AFastToolDoesNotPassThroughInAnyOrientation) {
  std::mt19937 random(1);
  std::normal_distribution<double> part;
  for (int i = 0; i < 12; ++i) {
    const Quat turned =
        i == 0 ? Quat::Identity() : Quat(part(random), part(random), part(random), part(random)).normalized();
    Rig rig(block(Vec3(60e-3, 60e-3, 2e-3), 0.1), one_part_tool(geometry::make_ball(3e-3, 1280)),
            plain_tissue());
    rig.tick({turned, Vec3(0, 0, 8e-3)});
    const ToolResult& result = rig.tick({turned, Vec3(0, 0, -7e-3)});  // completely below the plate, 15 m/s
    EXPECT_EQ(result.phase, Phase::kPress) << i;
    EXPECT_NEAR(result.depth, 10e-3, 0.1e-3) << i;
    EXPECT_GT(result.force_W.z(), 0.0) << i;
  }
}

TEST(Press, StartedOrPlacedInsideThereIsNoForceUntilItHasBeenOutside) {
  Rig rig(block(Vec3(60e-3, 60e-3, 20e-3), 0.1), one_part_tool(geometry::make_ball(3e-3, 1280)),
          plain_tissue());
  EXPECT_EQ(rig.tick(place(Vec3(0, 0, -5e-3))).status & kStartedInside, kStartedInside);
  EXPECT_EQ(rig.move_to(Vec3(4e-3, 0, -1e-3), kSpeed).force_W, Vec3::Zero());
  rig.move_to(Vec3(4e-3, 0, 5e-3), kSpeed);
  EXPECT_GT(rig.move_to(Vec3(4e-3, 0, -1e-3), kSpeed).force_W.z(), 0.0);
  rig.move_to(Vec3(4e-3, 0, 40e-3), 1.0);
  EXPECT_EQ(rig.tick(place(Vec3(0, 0, -4e-3))).status & kJump, kJump);  // 44 m/s is a jump
  EXPECT_EQ(rig.hold(0.1).force_W, Vec3::Zero());
}

TEST(Press, DampingAddsBTimesTheSpeedOncePastAMillimetreAndNeverPulls) {
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.damping = 2.0;
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), tissue);
  rig.tick(place(Vec3(0, 0, 5e-3)));
  const double depth = 6e-3;
  const ToolResult in = rig.move_to(Vec3(0, 0, -depth - lowest_z(ball)), 20e-3);
  EXPECT_NEAR(in.force_W.z(), law(rig, in.depth) + 2.0 * 20e-3, 1e-4);
  rig.each_tick([](const ToolResult& result) { EXPECT_GE(result.force_W.z(), 0.0); });
  rig.move_to(Vec3(0, 0, 5e-3), 200e-3);
}

TEST(Press, TheFullForceIsThereAtOnceWhenAToolComesFromOutside) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
  rig.tick(place(Vec3(0, 0, 4e-3)));
  rig.each_tick([&](const ToolResult& result) {
    const double depth = -(rig.pose().position.z() + lowest_z(ball));
    if (depth > 0.1e-3) {
      EXPECT_NEAR(result.force_W.z(), law(rig, depth), 0.01 * law(rig, depth) + 1e-9);
    }
  });
  rig.move_to(Vec3(0, 0, -2e-3), 100e-3);
}

TEST(Press, TheSameShapesAtFourTimesTheTrianglesGiveTheSameForceAndTorque) {
  const geometry::TriangleMesh organ = geometry::make_ball(25e-3, 1280);
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 320);
  ToolResult results[2];
  for (int fine = 0; fine < 2; ++fine) {
    Rig rig(fine != 0 ? geometry::subdivide(organ) : organ,
            one_part_tool(fine != 0 ? geometry::subdivide(ball) : ball), plain_tissue());
    const double top = geometry::bounds(organ).high.z();
    rig.tick(place(Vec3(6e-3, 2e-3, top + 4e-3)));
    rig.move_to(Vec3(6e-3, 2e-3, top - 6e-3), 20e-3);
    results[fine] = rig.hold(0.3);
  }
  const double force = results[0].force_W.norm();
  ASSERT_GT(force, 0.0);
  EXPECT_LT((results[1].force_W - results[0].force_W).norm(), 0.02 * force);
  EXPECT_LT((results[1].torque_W - results[0].torque_W).norm(), 0.02 * force * 10e-3);
}

TEST(Press, NoContactIsLostInRandomMotion) {
  const geometry::TriangleMesh organ = geometry::make_ball(20e-3, 1280);
  Rig rig(organ, one_part_tool(geometry::make_ball(3e-3, 320)), plain_tissue());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Vec3 position(0, 0, 26e-3);
  Vec3 velocity = Vec3::Zero();
  rig.tick(place(position));
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 goal = 19e-3 * position.normalized();  // the ball's deepest point is about 4 mm inside
    velocity += 0.04 * (goal - position) + 8e-4 * Vec3(normal(random), normal(random), normal(random)) -
                0.01 * velocity;
    position += 1e-3 * velocity;
    const ToolResult& result = rig.tick(place(position));
    if (result.distance > -0.6e-3) continue;
    ++inside;
    ASSERT_EQ(result.phase, Phase::kPress) << "tick " << i;
    ASSERT_GT(result.force_W.norm(), 0.0) << "tick " << i;
  }
  EXPECT_GT(inside, 5000);
}

/// A plate 34 mm long whose lower side bulges by 1.5 mm in the middle.
geometry::TriangleMesh bulged_plate() {
  geometry::TriangleMesh plate = geometry::make_box(Vec3(34e-3, 4e-3, 2e-3), 0.5e-3);
  for (Vec3& v : plate.vertices) {
    const double along = v.x() / 4e-3;
    if (v.z() < 0.0) v.z() -= 1.5e-3 * std::exp(-along * along);
  }
  return plate;
}

/// The plate with its bulge pressed 2 mm in. It then turns about the bulge until its end is far deeper.
class TurnedPlate final {
 public:
  TurnedPlate() : rig_(block(kBox, 1.0), one_part_tool(bulged_plate()), plain_tissue()) {
    rig_.each_tick([this](const ToolResult& result) { steps_(result); });
    rig_.tick(place(Vec3(0, 0, 10e-3)));
    rig_.move_to(kPressed, kSpeed);
  }

  /// Turns between two angles [mrad], `speed` [mrad] per tick.
  const ToolResult& turn(int from, int to, int speed = 1) {
    for (int angle = from; angle != to;) {
      angle += to > from ? speed : -speed;
      rig_.tick({Quat(Eigen::AngleAxisd(1e-3 * angle, Vec3::UnitY())), kPressed});
      if (rig_.result().view_count != 2) continue;
      farthest_ = std::max(farthest_, bulge().x());
      last_drawn_ = rig_.result().views[0].depth;
    }
    return rig_.result();
  }

  const ToolResult& hold(double seconds) { return rig_.hold(seconds); }

  /// Position of the bulge's contact, or of the only one.
  [[nodiscard]] Vec3 bulge() const { return rig_.result().views[0].point_S; }
  [[nodiscard]] double farthest() const { return farthest_; }
  /// The bulge's displayed depth when there last were two contacts [m].
  [[nodiscard]] double last_drawn() const { return last_drawn_; }
  [[nodiscard]] const StepMeter& steps() const { return steps_; }

 private:
  static inline const Vec3 kPressed{0, 0, 0.5e-3};
  Rig rig_;
  StepMeter steps_;
  double farthest_ = 0.0;
  double last_drawn_ = 0.0;
};

TEST(Press, AContactThatHasLostItsDeepestPlaceToADeeperOneFadesBeforeItWalksThere) {
  TurnedPlate plate;
  const ToolResult before = plate.turn(0, 200);
  ASSERT_EQ(before.view_count, 2);
  EXPECT_LT(plate.bulge().x(), 1e-3) << "the bulge is deepest still";
  EXPECT_GT(before.views[1].point_S.x(), 15e-3) << "the end";
  plate.turn(200, 340);
  EXPECT_LT(plate.farthest(), 8e-3) << "gone on its way, which is 15 mm";
  EXPECT_LT(plate.last_drawn(), 0.1e-3) << "3 mm deep by now, and faded in the picture too";
  const ToolResult after = plate.turn(340, 400);
  EXPECT_EQ(after.view_count, 1);
  EXPECT_GT(after.views[0].point_S.x(), 15e-3);
  EXPECT_LT(plate.steps().force_step(), 0.01);
  EXPECT_LT(plate.steps().torque_step(), 0.015);
}

TEST(Press, ALostContactGetsNoDeeperOnItsWay) {
  TurnedPlate plate;
  plate.turn(0, 200);
  constexpr int kSpeed = 10;  // mrad per tick: the plate's depth grows faster than the contact fades
  int angle = 200;
  for (double before = 1.0; plate.turn(angle, angle + kSpeed, kSpeed).view_count == 2 && angle < 500;) {
    angle += kSpeed;
    const double drawn = plate.last_drawn();
    if (plate.bulge().x() > 1.5e-3) {
      EXPECT_LT(drawn, before);
    }
    before = drawn;
  }
}

TEST(Press, AContactDoesNotStartWhereItWouldBeLostAtOnce) {
  for (const int angle : {210, 215, 220, 240}) {  // mrad; the bulge has no local maximum of depth there
    const Quat turned(Eigen::AngleAxisd(1e-3 * angle, Vec3::UnitY()));
    Rig rig(block(kBox, 1.0), one_part_tool(bulged_plate()), plain_tissue());
    rig.tick({turned, Vec3(0, 0, 15e-3)});
    rig.each_tick([&](const ToolResult& result) { EXPECT_LT(result.view_count, 2) << angle; });
    rig.move_to(Vec3(0, 0, 0.5e-3), 5e-3);
  }
}

TEST(Press, ALostContactThatFindsADeepestPlaceAgainComesBack) {
  TurnedPlate plate;
  plate.turn(0, 150);
  const double before = plate.hold(50e-3).force_W.norm();
  plate.turn(150, 240, 3);
  EXPECT_GT(plate.bulge().x(), 1.5e-3) << "on its way";
  plate.turn(240, 150, 3);
  const ToolResult again = plate.hold(50e-3);
  EXPECT_EQ(again.view_count, 2);
  EXPECT_LT(plate.bulge().x(), 1e-3);
  EXPECT_NEAR(again.force_W.norm(), before, 0.01 * before);
}

/// A plate with two feet of 1 mm on its lower side, 6 mm apart.
geometry::TriangleMesh plate_on_feet() {
  geometry::TriangleMesh plate = geometry::make_box(Vec3(14e-3, 4e-3, 2e-3), 0.25e-3);
  for (Vec3& v : plate.vertices) {
    const double aside = (std::abs(v.x()) - 3e-3) / 1e-3;
    if (v.z() < 0.0) v.z() -= 1e-3 * std::exp(-aside * aside);
  }
  return plate;
}

TEST(Press, TheForcesPlaceDoesNotJumpFromOneDeepestPlaceToAnother) {
  Rig rig(block(kBox, 1.0), one_part_tool(plate_on_feet()), plain_tissue());
  rig.tick(place(Vec3(0, 0, 15e-3)));
  const Vec3 pressed(0, 0, 1e-3);
  rig.tick({Quat(Eigen::AngleAxisd(-0.06, Vec3::UnitY())), Vec3(0, 0, 15e-3)});
  rig.move_to(pressed, kSpeed);
  rig.hold(0.2);
  const double before = rig.result().torque_W.y();
  StepMeter steps;
  rig.each_tick([&](const ToolResult& result) { steps(result); });
  for (int i = -6; i <= 6; ++i) rig.tick({Quat(Eigen::AngleAxisd(0.01 * i, Vec3::UnitY())), pressed});
  rig.hold(0.2);
  EXPECT_NEAR(rig.result().torque_W.y(), -before, 0.05 * std::abs(before)) << "the other foot's";
  EXPECT_LT(steps.torque_step(), 0.02);
}

TEST(Press, ASlowTurnIsFollowedWhicheverWayTheContactWalkedLast) {
  for (const int way : {1, -1}) {
    Rig rig(geometry::make_ball(20e-3, 5120), one_part_tool(plate_on_feet()), plain_tissue());
    const Vec3 pressed(0, 0, 21e-3);
    const auto turn = [&](int from, int to, int speed) {  // [0.01 mrad]
      for (int angle = from; angle != to; angle += to > from ? speed : -speed)
        rig.tick({Quat(Eigen::AngleAxisd(1e-5 * angle * way, Vec3::UnitY())), pressed});
      return 1e3 * way * rig.result().views[0].point_S.x();  // [mm]
    };
    rig.tick(place(Vec3(0, 0, 30e-3)));
    rig.move_to(pressed, kSpeed);
    rig.hold(0.2);
    const double slowly = turn(0, 2000, 1);
    EXPECT_GT(slowly, 0.25) << way;
    turn(2000, 3000, 20);
    EXPECT_NEAR(turn(3000, 2000, 20), slowly, 0.01) << way;
  }
}

TEST(Press, AMovedOrganIsFeltWhereItIs) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
  rig.organ_W = {rotation_from_degrees(Vec3(0, 90, 0)), Vec3(0.1, 0.0, 0.2)};  // its top faces +x
  rig.tick(place(Vec3(0.105, 0, 0.2)));
  rig.move_to(Vec3(0.101, 0, 0.2), kSpeed);
  const ToolResult& result = rig.hold(0.1);
  const double depth = 2e-3;
  EXPECT_NEAR(result.force_W.x(), law(rig, depth), 0.02 * law(rig, depth));
  EXPECT_NEAR(result.contact_W.x(), 0.1, 1e-5);
}

TEST(Press, DistanceIsExactInApproachAndNegativeInside) {
  const geometry::TriangleMesh ball = geometry::make_ball(3e-3, 1280);
  Rig rig(block(kBox, 0.1), one_part_tool(ball), plain_tissue());
  rig.tick(place(Vec3(0, 0, 30e-3)));
  rig.each_tick([&](const ToolResult& result) {
    EXPECT_NEAR(result.distance, rig.pose().position.z() + lowest_z(ball), 1e-9);
  });
  rig.move_to(Vec3(3e-3, 1e-3, -2e-3), 50e-3);
  EXPECT_LT(rig.result().distance, 0.0);
}

TEST(World, RefusesAToolWithoutPartsAndAnOpenOrgan) {
  const geometry::Tool ball = one_part_tool(geometry::make_ball(3e-3, 80));
  EXPECT_THROW(World(block(kBox, 0.1), {geometry::Tool{}}, plain_tissue(), 1e-3), InputError);
  EXPECT_THROW(World(block(kBox, 0.1), {}, plain_tissue(), 1e-3), InputError);
  EXPECT_THROW(World(block(kBox, 0.1), {one_part_tool({})}, plain_tissue(), 1e-3), InputError);
  const std::vector<geometry::Tool> too_many(kMaxHands + 1, ball);
  EXPECT_THROW(World(block(kBox, 0.1), too_many, plain_tissue(), 1e-3), InputError);
  geometry::TriangleMesh open = block(kBox, 0.1);
  open.triangles.pop_back();
  EXPECT_THROW(World(open, {ball}, plain_tissue(), 1e-3), InputError);
  model::TissueParameters bad = plain_tissue();
  bad.q = -1.0;
  EXPECT_THROW(World(block(kBox, 0.1), {ball}, bad, 1e-3), ParameterError);
}

}  // namespace
}  // namespace palpate::contact::test
