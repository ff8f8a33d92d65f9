#include "core/haptics/simulation.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/charconv.h"
#include "core/haptics/test/test_world.h"
#include "core/haptics/warm_up.h"
#include "core/model/tissue_fields.h"
#include "palpate/error.h"

namespace palpate::haptics {
namespace {

using test::block_and_balls;
using test::no_noise;
using test::pressing;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Bench {
  explicit Bench(std::size_t hands, noise::NoiseSettings noise = {})
      : world(block_and_balls(hands, 1000.0, noise)),
        state(world),
        samples(hands),
        commands(hands),
        rows(hands) {}
  void step() { tick(world, state, number++, samples, commands, rows); }
  void press(int ticks, std::size_t hand = 0) {
    for (int i = 0; i < ticks; ++i) {
      samples[hand] = pressing(static_cast<double>(number) * 1e-3);
      step();
    }
  }

  SimulationWorld world;
  SimulationState state;
  std::vector<DeviceState> samples;
  std::vector<ForceCommand> commands;
  std::vector<TickRow> rows;
  std::uint64_t number = 0;
};

bool all_finite(const TickRow& row) {
  for (const auto* three : {&row.force, &row.torque, &row.tool, &row.contact, &row.normal}) {
    for (const double x : *three) {
      if (!std::isfinite(x)) return false;
    }
  }
  for (const double x : row.tool_q) {
    if (!std::isfinite(x)) return false;
  }
  return std::isfinite(row.distance) && std::isfinite(row.depth) && std::isfinite(row.tissue_force) &&
         std::isfinite(row.noise_force) && std::isfinite(row.friction) && std::isfinite(row.gripper_force) &&
         std::isfinite(row.gripper);
}

double norm(const std::array<double, 3>& v) { return Vec3(v[0], v[1], v[2]).norm(); }

TEST(Tick, InApproachThereIsNothingButNoiseAlongTheLineAwayFromTheTissue) {
  Bench bench(1);
  bench.samples[0].position_D = Vec3(0, 0, 0.003 + test::kBallRadius);
  for (int i = 0; i < 200; ++i) {
    bench.step();
    const TickRow& row = bench.rows[0];
    ASSERT_EQ(row.phase, 0u);
    ASSERT_EQ(row.tissue_force, 0.0);
    ASSERT_NEAR(row.force[2], row.noise_force, 1e-15) << "positive noise is away from the tissue: up";
    ASSERT_NEAR(norm(row.force), std::abs(row.noise_force), 1e-15);
    ASSERT_NEAR(row.distance, 0.003, 1e-9);
    ASSERT_NEAR(row.time, 1e-3 * i, 1e-15);
  }
}

TEST(Tick, InContactTheHandFeelsTheTissueForcePlusTheNoiseAlongTheNormal) {
  Bench bench(1);
  bench.press(450);
  const TickRow& row = bench.rows[0];
  EXPECT_EQ(row.phase, 1u);
  EXPECT_GT(row.depth, 0.003);
  EXPECT_GT(row.tissue_force, 0.05);
  EXPECT_NE(row.noise_force, 0.0);
  const Vec3 expected =
      bench.state.results[0].force_W + row.noise_force * Vec3(row.normal[0], row.normal[1], row.normal[2]);
  EXPECT_NEAR((Vec3(row.force[0], row.force[1], row.force[2]) - expected).norm(), 0.0, 1e-12);
}

TEST(Tick, ADeviceWithWarmMotorsIsGivenLessForceWithTheSameTissue) {
  Bench cold(1);
  Bench warm(1);
  cold.world.limits.continuous_force = warm.world.limits.continuous_force = 5.0;
  cold.press(5000);
  for (int i = 0; i < 5000; ++i) {
    warm.samples[0] = pressing(static_cast<double>(warm.number) * 1e-3);
    warm.samples[0].events = kMotorsWarm;
    warm.step();
  }
  EXPECT_EQ(cold.rows[0].status & kDutyLimited, 0U);
  EXPECT_EQ(warm.rows[0].status & kDutyLimited, kDutyLimited);
  EXPECT_EQ(warm.rows[0].events, kMotorsWarm) << "recorded, so that a replay does the same";
  EXPECT_EQ(warm.rows[0].tissue_force, cold.rows[0].tissue_force);
  EXPECT_LT(norm(warm.rows[0].force), 0.3 * norm(cold.rows[0].force));
}

TEST(Tick, NoiseIsThatOfTheDistanceInApproachAndOfContactInContact) {
  Bench bench(1);
  noise::TouchNoise::State level;
  for (int i = 0; i < 600; ++i) {
    bench.press(1);
    const TickRow& row = bench.rows[0];
    const double distance = row.phase == 0 ? row.distance : 0.0;
    ASSERT_EQ(row.noise_force, bench.world.noise.force(level, true, 0, row.tick, distance)) << i;
  }
}

TEST(Tick, ACopyOfTheStateReplaysTheSameBits) {
  Bench bench(2);
  bench.press(350);
  Bench copy(2);
  copy.state = bench.state;
  copy.number = bench.number;
  copy.samples = bench.samples;
  for (int i = 0; i < 300; ++i) {
    bench.press(1);
    copy.press(1);
    ASSERT_TRUE(test::same_bits(bench.rows[0], copy.rows[0])) << i;
    ASSERT_TRUE(test::same_bits(bench.rows[1], copy.rows[1])) << i;
  }
}

TEST(Tick, EveryKindOfBadSampleLatchesItsFaultAndLeavesFiniteRows) {
  struct Case {
    const char* what;
    Fault fault;
    void (*spoil)(DeviceState&);
  };
  const Case cases[] = {
      {"not valid", Fault::kDevice, [](DeviceState& s) { s.fault = Fault::kDevice; }},
      {"position NaN", Fault::kNotFinite, [](DeviceState& s) { s.position_D.y() = kNaN; }},
      {"position infinite", Fault::kNotFinite, [](DeviceState& s) { s.position_D.z() = -kInf; }},
      {"position far", Fault::kDevice, [](DeviceState& s) { s.position_D.x() = 1e9; }},
      {"velocity NaN", Fault::kNotFinite, [](DeviceState& s) { s.velocity_D.x() = kNaN; }},
      {"gripper NaN", Fault::kNotFinite, [](DeviceState& s) { s.gripper = kNaN; }},
      {"quaternion NaN", Fault::kNotFinite, [](DeviceState& s) { s.orientation_D.w() = kNaN; }},
      {"quaternion zero", Fault::kDevice, [](DeviceState& s) { s.orientation_D.coeffs().setZero(); }},
      {"quaternion long", Fault::kDevice, [](DeviceState& s) { s.orientation_D.coeffs() *= 1.2; }},
  };
  for (const Case& bad : cases) {
    Bench bench(1);
    bench.press(450);
    const std::array<double, 3> held = bench.rows[0].tool;
    bad.spoil(bench.samples[0]);
    bench.step();
    EXPECT_EQ(bench.rows[0].fault, static_cast<std::uint32_t>(bad.fault)) << bad.what;
    EXPECT_TRUE(all_finite(bench.rows[0])) << bad.what;
    EXPECT_EQ(bench.rows[0].tool, held) << bad.what << ": the last good pose holds";
    EXPECT_EQ(bench.rows[0].noise_force, 0.0) << bad.what;
    bench.samples[0] = pressing(0.45);
    for (int i = 0; i < 9; ++i) bench.step();
    for (int i = 0; i < 100; ++i) {
      bench.step();
      ASSERT_EQ(norm(bench.rows[0].force), 0.0) << bad.what;
      ASSERT_EQ(bench.rows[0].fault, static_cast<std::uint32_t>(bad.fault)) << bad.what;
    }
  }
}

TEST(Tick, ABadFirstSampleIsAFaultWithoutForce) {
  Bench bench(1);
  bench.samples[0].position_D.x() = kNaN;
  bench.step();
  EXPECT_EQ(bench.rows[0].fault, static_cast<std::uint32_t>(Fault::kNotFinite));
  EXPECT_TRUE(all_finite(bench.rows[0]));
  EXPECT_EQ(norm(bench.rows[0].force), 0.0);
}

TEST(Tick, NoAllowedTissueNumberMakesAForceThatIsNotFinite) {
  Bench bench(1, no_noise());
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.key == std::string_view("reference_radius_mm")) continue;  // another preparation
    for (const double value : {0.0, 5e-324, 1e-300, 1e-9, field.range.high, 1e6, 1e9, 1e300, 1e308}) {
      model::TissueParameters tissue = model::tissue_preset("gallbladder");
      field.at.set(tissue, value);
      bench.state = SimulationState(bench.world);
      bench.number = 240;
      try {
        contact::change_tissue(bench.world.contact, bench.state.contact, {tissue, 1e-3});
      } catch (const ParameterError&) {
        continue;  // refused
      }
      bench.press(200);
      EXPECT_EQ(bench.rows[0].fault, 0u) << field.key << " = " << value;
      EXPECT_EQ(bench.rows[0].phase, 1) << field.key << " = " << value;
    }
  }
}

TEST(Tick, AFaultOnOneHandLeavesTheOtherAlone) {
  Bench both(2, no_noise());
  Bench lone(2, no_noise());
  for (Bench* bench : {&both, &lone}) {
    bench->samples[1].position_D = Vec3(0.02, 0.02, 0.05);
    bench->press(450);
  }
  both.samples[1].fault = Fault::kDevice;
  both.press(100);
  lone.press(100);
  EXPECT_EQ(both.rows[1].fault, static_cast<std::uint32_t>(Fault::kDevice));
  EXPECT_TRUE(test::same_bits(both.rows[0], lone.rows[0]));
}

TEST(Tick, TheGripperIsBroughtIntoItsRange) {
  Bench bench(1);
  bench.samples[0].position_D.z() = 0.02;
  bench.samples[0].gripper = 1.5;
  bench.step();
  EXPECT_EQ(bench.rows[0].gripper, 1.0);
  EXPECT_EQ(bench.rows[0].device_gripper, 1.5);
  bench.samples[0].gripper = -0.5;
  bench.step();
  EXPECT_EQ(bench.rows[0].gripper, 0.0);
}

TEST(Tick, TheNoiseCanBeSwitchedOff) {
  Bench bench(1, no_noise());
  bench.press(600);
  EXPECT_EQ(bench.rows[0].noise_force, 0.0);
}

std::vector<std::uint64_t> bits_of(const TickRow& row) {
  std::vector<std::uint64_t> bits{row.tick, row.phase, row.status, row.fault, row.cutoff_layer};
  for (const double value : {row.distance, row.depth, row.tissue_force, row.noise_force, row.friction,
                             row.energy, row.engagement}) {
    bits.push_back(bit_cast<std::uint64_t>(value));
  }
  for (const auto* three : {&row.force, &row.torque, &row.tool, &row.contact, &row.normal}) {
    for (const double value : *three) bits.push_back(bit_cast<std::uint64_t>(value));
  }
  return bits;
}

TEST(WarmUp, ChangesNoBitOfARunThatTouches) {
  Bench cold(2);
  Bench warm(2);
  warm_up(warm.world, warm.state);
  bool touched = false;
  for (int k = 0; k < 600; ++k) {
    for (Bench* bench : {&cold, &warm}) {
      for (DeviceState& sample : bench->samples) sample = pressing(k * 1e-3);
      bench->step();
    }
    for (const std::size_t hand : {0U, 1U}) {
      ASSERT_EQ(bits_of(warm.rows[hand]), bits_of(cold.rows[hand])) << "tick " << k;
      touched = touched || warm.rows[hand].tissue_force > 0.0;
    }
  }
  EXPECT_TRUE(touched);
}

TEST(WarmUp, LeavesTheStateOfAStartedRun) {
  Bench one(1);
  one.press(400);
  const SimulationState before = one.state;
  warm_up(one.world, one.state);
  EXPECT_EQ(one.state.inputs[0].pose_W.position, before.inputs[0].pose_W.position);
  EXPECT_EQ(one.state.results[0].force_W, before.results[0].force_W);
  Bench other(1);
  other.press(400);
  one.press(100);
  other.press(100);
  EXPECT_EQ(bits_of(one.rows[0]), bits_of(other.rows[0]));
}

}  // namespace
}  // namespace palpate::haptics
