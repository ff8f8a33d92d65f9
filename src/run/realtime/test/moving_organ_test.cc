// An organ that breathes or beats: the force depends on the relative motion of tool and organ.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "run/realtime/loop.h"

namespace palpate::realtime {
namespace {

using haptics::test::kBallRadius;
using model::OrganMotion;
using model::OrganMotionKind;
using model::OrganMotionParameters;

constexpr double kRate = 1000.0;
const double kPi = std::acos(-1.0);

OrganMotionParameters breathing(double amplitude, const Vec3& direction = Vec3::UnitZ()) {
  OrganMotionParameters motion = model::organ_motion_preset(OrganMotionKind::kBreathing);
  motion.amplitude = amplitude;
  motion.direction_W = direction;
  return motion;
}

OrganMotionParameters twisting(double angle, double period) {
  OrganMotionParameters motion = model::organ_motion_preset(OrganMotionKind::kHeartbeat);
  motion.rotation = angle;
  motion.period = period;
  return motion;
}

/// The moving block of test_world.h and one ball.
struct MovingBench {
  explicit MovingBench(std::vector<OrganMotionParameters> motions,
                       const noise::NoiseSettings& noise = haptics::test::no_noise())
      : world(haptics::test::block_and_balls(1, kRate, noise)),
        state(world),
        samples(1),
        commands(1),
        rows(1) {
    world.organ_motion = OrganMotion(std::move(motions), Vec3::Zero());
  }
  [[nodiscard]] Pose organ_now() const { return world.organ_motion.pose_at(world.organ_W, number, kRate); }
  const haptics::TickRow& step(const Pose& tool) {
    samples[0].position_D = tool.position;
    samples[0].orientation_D = tool.rotation;
    haptics::tick(world, state, number++, samples, commands, rows);
    return rows[0];
  }
  const haptics::TickRow& step(const Vec3& position) { return step(Pose{Quat::Identity(), position}); }

  haptics::SimulationWorld world;
  haptics::SimulationState state;
  std::vector<haptics::DeviceState> samples;
  std::vector<haptics::ForceCommand> commands;
  std::vector<haptics::TickRow> rows;
  std::uint64_t number = 0;
};

Vec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// Position of a ball in the organ's frame, whose top is at z = 20 mm. The ball presses 3 mm deep, slides 4
/// mm at up to 15 mm/s and stops.
Vec3 pressing_and_sliding(double time) {
  const double down = std::min(time, 0.3) / 0.3;
  const double aside = std::clamp((time - 0.4) / 0.4, 0.0, 1.0);
  const double way = aside * aside * (3.0 - 2.0 * aside);
  return {0.001 + 0.004 * way, 0.002, 0.020 + kBallRadius + 0.004 - 0.007 * down};
}

TEST(MovingOrgan, AToolHeldStillFeelsTheForceFollowTheBreath) {
  MovingBench bench({breathing(0.006)});
  const Vec3 held(0.001, 0.002,
                  kBallRadius + 0.002);  // 2 mm above the top; breathing lifts the top to a depth of 4 mm
  const auto [most, least] = std::pair(0.004, -0.002);
  double deepest = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const haptics::TickRow& row = bench.step(held);
    const double lifted = 0.006 * std::pow(std::sin(kPi * i / 4000.0), 6);
    ASSERT_NEAR(-row.distance, lifted + least, 1e-6) << i;
    // The surface of a ball of 80 vertices is less than 0.1 mm from its sphere. Damping acts while the depth
    // changes.
    ASSERT_NEAR(row.depth, std::max(0.0, lifted + least), 0.1e-3) << i;
    ASSERT_EQ(row.phase != 0, row.depth > 0.0);
    const double law = bench.world.contact.press_law().force_at(row.depth).force;
    ASSERT_NEAR(row.force[2], law, 0.012) << "0.5 N s/m at 7.3 mm/s is 4 mN, and let in over 50 ms";
    deepest = std::max(deepest, row.depth);
  }
  EXPECT_NEAR(deepest, most, 0.1e-3);
  EXPECT_EQ(bench.rows[0].depth, 0.0) << "it has left again";
}

TEST(MovingOrgan, AToolCarriedAlongFeelsTheSameAsOnAStillOrgan) {
  MovingBench still({});
  MovingBench moving({breathing(0.010, Vec3(0.6, 0, 0.8)), twisting(0.2, 0.9)});
  double largest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const Pose tool_S{Quat::Identity(), pressing_and_sliding(i / kRate)};
    const haptics::TickRow& a = still.step(still.world.organ_W * tool_S);
    const Pose organ_W = moving.organ_now();
    const haptics::TickRow& b = moving.step(organ_W * tool_S);
    ASSERT_EQ(a.phase, b.phase) << i;
    ASSERT_NEAR(a.depth, b.depth, 1e-9) << i;
    ASSERT_NEAR(a.friction, b.friction, 1e-7) << i;
    ASSERT_NEAR((organ_W.rotation * vector(a.force) - vector(b.force)).norm(), 0.0, 1e-7) << i;
    ASSERT_NEAR((organ_W.rotation * vector(a.torque) - vector(b.torque)).norm(), 0.0, 1e-9) << i;
    largest = std::max(largest, a.friction);
  }
  EXPECT_GT(largest, 0.005) << "the way slides";
}

TEST(MovingOrgan, OnlyTheMotionBetweenToolAndOrganCountsForForceDampingAndFriction) {
  // Either the organ breathes under a held tool, or the tool makes the opposite motion at a still organ.
  MovingBench organ_moves({breathing(0.006, Vec3(0.6, 0, 0.8))});
  MovingBench tool_moves({});
  const Vec3 held(0.001, 0.002, kBallRadius + 0.001);
  double friction = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const Vec3 moved = organ_moves.organ_now().position - organ_moves.world.organ_W.position;
    const haptics::TickRow& a = organ_moves.step(held);
    const haptics::TickRow& b = tool_moves.step(held - moved);
    ASSERT_NEAR((vector(a.force) - vector(b.force)).norm(), 0.0, 1e-7) << i;
    ASSERT_NEAR(a.friction, b.friction, 1e-7) << i;
    ASSERT_NEAR((vector(a.contact) - vector(b.contact) - moved).norm(), 0.0, 1e-9) << i;
    friction = std::max(friction, a.friction);
  }
  EXPECT_GT(friction, 0.005) << "the breath goes aside too";
}

TEST(MovingOrgan, AFastBeatNeitherPassesThroughAHeldToolNorHoldsItAfterwards) {
  OrganMotionParameters beat = twisting(0.0, 0.25);
  beat.amplitude = 0.030;  // m; the largest speed is 0.675 m/s
  MovingBench bench({beat});
  const Vec3 held(0.001, 0.002, kBallRadius + 0.025);
  int entries = 0;
  bool was_touching = false;
  for (int i = 0; i < 1000; ++i) {
    const haptics::TickRow& row = bench.step(held);
    const bool touching = row.phase != 0;
    if (touching && !was_touching) ++entries;
    was_touching = touching;
    ASSERT_EQ(row.fault, 0u);
    ASSERT_EQ(row.status & (contact::kJump | contact::kStartedInside), 0u) << i;
    ASSERT_TRUE(row.distance <= 1e-6 || row.depth == 0.0) << i;
  }
  EXPECT_EQ(entries, 4) << "one a beat";
}

TEST(MovingOrgan, NoiseFollowsTheDistanceToTheMovingOrgan) {
  MovingBench bench({breathing(0.008)}, noise::NoiseSettings{});
  noise::TouchNoise::State level;
  const Vec3 held(0, 0, kBallRadius + 0.010);
  double nearest = 1.0;
  for (int i = 0; i < 4000; ++i) {
    const haptics::TickRow& row = bench.step(held);
    ASSERT_EQ(row.phase, 0u);
    ASSERT_EQ(row.noise_force, bench.world.noise.force(level, true, 0, row.tick, row.distance)) << i;
    nearest = std::min(nearest, row.distance);
  }
  EXPECT_NEAR(nearest, 0.002, 1e-6);
}

TEST(MovingOrgan, AGripCarriedAlongKeepsItsStretchAndAHeldOneIsPulledByTheBreath) {
  MovingBench carried({breathing(0.008)});
  MovingBench held({breathing(0.008)});
  for (int i = 0; i < 2000; ++i) {
    const double gripper = i < 100 ? 1.0 : std::max(0.0, 1.0 - (i - 100) / 100.0);
    carried.samples[0].gripper = held.samples[0].gripper = gripper;
    const Vec3 at(0.001, 0.002, kBallRadius + 0.0005);
    const haptics::TickRow& a = carried.step(carried.organ_now().position + Vec3(0, 0, 0.02) + at);
    const haptics::TickRow& b = held.step(at);
    if (i < 300) continue;
    ASSERT_EQ(a.phase, 2u) << i;
    ASSERT_EQ(b.phase, 2u) << i;
    ASSERT_NEAR(a.depth, 0.0, 1e-12) << i;
    // The motion before the jaws closed, at about 170 ms, is below 1 um.
    ASSERT_NEAR(b.depth, 0.008 * std::pow(std::sin(kPi * i / 4000.0), 6), 1e-6) << i;
  }
  EXPECT_NEAR(held.rows[0].depth, 0.008, 1e-5);
  EXPECT_GT(held.rows[0].force[2], 0.1) << "tissue that came up to the tool pushes it on up";
}

TEST(MovingOrgan, TheSnapshotCarriesThePoseOfItsTick) {
  MovingBench bench({breathing(0.008)});
  haptics::SnapshotPublisher publisher;
  haptics::test::FakeDevice device([](std::uint64_t, double) {
    haptics::DeviceState state;
    state.position_D = Vec3(0, 0, 0.05);
    return state;
  });
  haptics::Device* const devices[] = {&device};
  (void)run_loop(bench.world, bench.state, devices, {&publisher}, {.ticks = 1501, .offline = true});
  ASSERT_TRUE(publisher.cell().refresh());
  const haptics::Snapshot& newest = publisher.cell().value();
  EXPECT_EQ(newest.tick, 1500u);
  EXPECT_EQ(newest.organ_W.position,
            bench.world.organ_motion.pose_at(bench.world.organ_W, 1500, kRate).position);
  EXPECT_GT((newest.organ_W.position - bench.world.organ_W.position).z(), 0.004);
}

TEST(MovingOrgan, ARunOfMovingTicksReplaysTheSameBitsFromACopyOfTheState) {
  MovingBench bench({breathing(0.006), twisting(0.1, 0.8)});
  for (int i = 0; i < 700; ++i) bench.step(Vec3(0.001, 0.002, kBallRadius));
  MovingBench copy({breathing(0.006), twisting(0.1, 0.8)});
  copy.state = bench.state;
  copy.number = bench.number;
  for (int i = 0; i < 700; ++i) {
    const haptics::TickRow a = bench.step(Vec3(0.001, 0.002, kBallRadius));
    ASSERT_TRUE(haptics::test::same_bits(a, copy.step(Vec3(0.001, 0.002, kBallRadius)))) << i;
  }
}

}  // namespace
}  // namespace palpate::realtime
