// The commanded force (LiveStimulus) in the tick.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/haptics/prepared_update.h"
#include "core/haptics/test/test_world.h"
#include "palpate/error.h"

namespace palpate::haptics {
namespace {

using test::block_and_balls;
using test::no_noise;
using test::pressing;

constexpr double kHigh = 0.02;  // m above the block

DeviceState above(double height) {
  DeviceState sample;
  sample.position_D = Vec3(0.001, 0.002, test::kBallRadius + height);
  return sample;
}

ParameterUpdate update_to(const LiveStimulus& stimulus) {
  ParameterUpdate update = parameter_update(model::tissue_preset("gallbladder"), {}, kStimulusChanged);
  update.stimulus = stimulus;
  return update;
}

struct StimulusBench {
  explicit StimulusBench(std::size_t hands, const noise::NoiseSettings& noise = no_noise())
      : world(block_and_balls(hands, 1000.0, noise)),
        state(world),
        samples(hands, above(kHigh)),
        commands(hands),
        rows(hands) {}
  void step() { tick(world, state, number++, samples, commands, rows); }
  void step(const DeviceState& sample) {
    samples[0] = sample;
    step();
  }
  void change(const LiveStimulus& stimulus) {
    apply_update(world, state, prepare_update(world, update_to(stimulus)));
  }
  [[nodiscard]] Vec3 force(std::size_t hand = 0) const {
    return {rows[hand].force[0], rows[hand].force[1], rows[hand].force[2]};
  }
  /// Its part of the force without friction and damping of the tissue.
  [[nodiscard]] Vec3 beside_tissue(std::size_t hand = 0) const {
    return force(hand) - state.results[hand].force_W;
  }

  SimulationWorld world;
  SimulationState state;
  std::vector<DeviceState> samples;
  std::vector<ForceCommand> commands;
  std::vector<TickRow> rows;
  std::uint64_t number = 0;
};

TEST(Stimulus, AStepRampsLinearlyAndReachesItsValueExactly) {
  StimulusBench bench(1);
  for (int i = 0; i < 5; ++i) bench.step();
  bench.change({0.3, 50e-3});
  for (int i = 1; i <= 50; ++i) {
    bench.step();
    ASSERT_NEAR(bench.rows[0].stimulus_force, 0.3 * i / 50.0, 1e-15) << i;
    ASSERT_NEAR(bench.force().z(), 0.3 * i / 50.0, 1e-15) << "above the block it points up";
  }
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.3);
  for (int i = 0; i < 100; ++i) bench.step();
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.3);
  bench.change({-0.1, 10e-3});
  for (int i = 1; i <= 4; ++i) bench.step();
  EXPECT_NEAR(bench.rows[0].stimulus_force, 0.3 - 0.4 * 0.4, 1e-15);
  bench.change({0.0, 20e-3});
  for (int i = 1; i <= 10; ++i) bench.step();
  EXPECT_NEAR(bench.rows[0].stimulus_force, 0.07, 1e-15) << "a ramp starts from the force of its time";
  for (int i = 1; i <= 10; ++i) bench.step();
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.0);
}

TEST(Stimulus, ItActsAlongTheDirectionOfTheNoiseInContactNearTheTissueAndFarFromIt) {
  noise::NoiseSettings strong;
  strong.gain = 100.0 * strong.gain * strong.threshold;
  strong.threshold = 0.5;  // the noise is felt far away, too
  StimulusBench noisy(1, strong);
  StimulusBench still(1);
  still.change({0.2, 10e-3});
  for (int i = 0; i < 1000; ++i) {
    DeviceState sample = pressing(1e-3 * i);
    if (i >= 600) sample = above(0.2 + 1e-4 * i);
    if (i >= 800) sample.position_D.x() = 0.1 + 1e-4 * i;
    noisy.step(sample);
    still.step(sample);
    if (i < 10) continue;
    ASSERT_EQ(still.rows[0].phase, noisy.rows[0].phase);
    ASSERT_NE(noisy.rows[0].noise_force, 0.0);
    ASSERT_LT((still.beside_tissue() / 0.2 - noisy.beside_tissue() / noisy.rows[0].noise_force).norm(), 1e-9)
        << i;
  }
}

TEST(Stimulus, AForceOfZeroChangesNoBit) {
  StimulusBench with(1, {});
  StimulusBench without(1, {});
  for (int i = 0; i < 600; ++i) {
    if (i % 40 == 0) with.change({0.0, 20e-3});
    with.step(pressing(1e-3 * i));
    without.step(pressing(1e-3 * i));
    ASSERT_TRUE(test::same_bits(with.rows[0], without.rows[0])) << i;
  }
}

TEST(Stimulus, AForceOfZeroKeepsEvenTheSignOfAZero) {
  GateState state;
  const ForceCommand tissue{Vec3(-0.0, -0.0, 1.0), Vec3::Zero(), 0.0};
  const GateOutput out = pass_gate({}, state, {.tissue = tissue, .noise = Vec3(-0.0, -0.0, 0.0)});
  EXPECT_TRUE(std::signbit(out.command.force.x()));
}

TEST(Stimulus, RandomStepsNeverPassTheForceLimitNorTheSlewLimit) {
  StimulusBench bench(1);
  bench.world.limits.max_force = 2.0;
  bench.world.limits.force_step = 0.05;
  std::mt19937_64 dice(11);
  std::uniform_real_distribution<double> wanted(-2.0, 2.0);
  Vec3 before = Vec3::Zero();
  std::uint32_t status = 0;
  for (int i = 0; i < 20'000; ++i) {
    if (dice() % 60 == 0) bench.change({wanted(dice), 10e-3 + 50e-3 * std::abs(wanted(dice))});
    bench.step(above(0.012 * std::sin(0.004 * i) - 0.006));
    ASSERT_LE(bench.force().norm(), 2.0 * (1 + 1e-12)) << i;
    ASSERT_LE((bench.force() - before).norm(), 0.05 * (1 + 1e-12)) << i;
    before = bench.force();
    status |= bench.rows[0].status;
  }
  EXPECT_NE(status & kForceClamped, 0U);
  EXPECT_NE(status & kForceSlewed, 0U);
}

TEST(Stimulus, AfterAFaultItIsZeroOnThatHandUntilTheNextUpdate) {
  StimulusBench bench(2);
  bench.change({0.5, 10e-3});
  for (int i = 0; i < 20; ++i) bench.step();
  bench.samples[0].fault = Fault::kDevice;
  bench.step();
  bench.samples[0].fault = Fault::kNone;
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.0);
  EXPECT_EQ(bench.state.stimuli[0].force(), 0.0);
  bench.change({0.7, 10e-3});
  for (int i = 0; i < 20; ++i) bench.step();
  EXPECT_EQ(bench.state.stimuli[0].force(), 0.0) << "an update during the fault does not count";
  EXPECT_EQ(bench.force(0), Vec3(Vec3::Zero()));
  bench.samples[0].events = kResetFault;
  for (int i = 0; i < 20; ++i) bench.step();
  EXPECT_EQ(bench.force(0), Vec3(Vec3::Zero())) << "a reset does not bring it back";
  EXPECT_EQ(bench.rows[1].stimulus_force, 0.7) << "the other hand goes on";
  bench.change({0.2, 10e-3});
  for (int i = 0; i < 20; ++i) bench.step();
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.2);
}

TEST(Stimulus, IntervalsMarkTheTickInWhichTheyBeginAndEnd) {
  StimulusBench bench(2);
  const auto events_with = [&bench](std::uint32_t interval) {
    bench.change({0.0, 10e-3, interval});
    bench.samples[1].events = kIntervalBegan | kIntervalEnded;  // a device cannot set them
    bench.step();
    EXPECT_EQ(bench.rows[0].events, bench.rows[1].events);
    const std::uint32_t events = bench.rows[0].events;
    bench.step();
    EXPECT_EQ(bench.rows[0].events, 0U) << "only in one tick";
    return events;
  };
  EXPECT_EQ(events_with(0), 0U);
  EXPECT_EQ(events_with(1), kIntervalBegan);
  EXPECT_EQ(events_with(1), 0U) << "the same interval goes on";
  EXPECT_EQ(events_with(2), kIntervalBegan | kIntervalEnded);
  EXPECT_EQ(events_with(0), kIntervalEnded);
}

TEST(Stimulus, ACopyOfTheStateInARampReplaysTheSameBits) {
  StimulusBench bench(2);
  bench.change({0.5, 0.1, 1});
  for (int i = 0; i < 40; ++i) bench.step(pressing(0.25 + 1e-3 * i));
  StimulusBench copy(2);
  copy.state = bench.state;
  copy.number = bench.number;
  for (int i = 40; i < 400; ++i) {
    bench.step(pressing(0.25 + 1e-3 * i));
    copy.step(pressing(0.25 + 1e-3 * i));
    ASSERT_TRUE(test::same_bits(bench.rows[0], copy.rows[0])) << i;
    ASSERT_TRUE(test::same_bits(bench.rows[1], copy.rows[1])) << i;
  }
}

TEST(Stimulus, ValuesOutOfRangeAreRefusedByName) {
  SimulationWorld world = block_and_balls(1, 1000.0);
  world.limits.max_force = 4.0;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto field_of = [&world](const LiveStimulus& stimulus) -> std::string {
    try {
      (void)prepare_update(world, update_to(stimulus));
    } catch (const ParameterError& error) {
      return error.field();
    }
    return "";
  };
  for (const double force : {4.001, -4.001, kNaN, kInf, -kInf}) EXPECT_EQ(field_of({force}), "force_N");
  for (const double ramp : {0.0, 9.9e-3, 10.1, -1.0, kNaN, kInf}) EXPECT_EQ(field_of({0.1, ramp}), "ramp_ms");
  EXPECT_EQ(field_of({0.1, 50e-3, 3}), "interval");
  for (const LiveStimulus& good : {LiveStimulus{4.0, 10e-3, 0}, {-4.0, 10.0, 2}, {0.0, 50e-3, 1}}) {
    EXPECT_EQ(field_of(good), "");
  }
}

/// Pushes a free mass with random steps of a commanded force through the gate of a held device.
/// @return by how much the energy given exceeds the promised bound at most [J]
double excess_over_bound(double mass, bool controlled) {
  constexpr double kPeriod = 1e-3;  // s
  std::mt19937_64 dice(5);
  std::uniform_real_distribution<double> wanted(-3.0, 3.0);
  GateState state;
  double speed = 0.0;
  double way = 0.0;
  double given = 0.0;
  double largest_tick = 0.0;
  double excess = -1.0;
  double force = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    if (i % 100 == 0) force = wanted(dice);
    const GateOutput out = pass_gate({}, state,
                                     {.stimulus = Vec3(force, 0.0, 0.0),
                                      .motion = {Vec3(way, 0.0, 0.0), Vec3::Zero()},
                                      .controlled = controlled});
    const double push = out.command.force.x();
    way = speed * kPeriod + 0.5 * push / mass * kPeriod * kPeriod;
    speed += push / mass * kPeriod;
    given += push * way;
    largest_tick = std::max(largest_tick, std::abs(push * way));
    const double bound = kEnergyTolerance + kNoisePower * kPeriod * i + 2.0 * kNoiseEnergy;
    excess = std::max(excess, given - bound - 2.0 * largest_tick);
  }
  return excess;
}

TEST(Stimulus, OnAHeldDeviceItGivesNoMoreEnergyThanTheNoiseMay) {
  for (const double mass : {0.02, 0.1, 0.5}) {
    EXPECT_LE(excess_over_bound(mass, true), 0.0) << mass;
    EXPECT_GT(excess_over_bound(mass, false), 1e-3) << "without the limit the bound is broken";
  }
}

TEST(Stimulus, WhatTheObserverLowersIsNotInTheRow) {
  StimulusBench bench(1);
  bench.world.mappings[0].held = true;
  for (int i = 0; i < 800; ++i) bench.step();  // soft start
  bench.change({0.5, 10e-3});
  for (int i = 0; i < 20; ++i) bench.step();
  EXPECT_EQ(bench.rows[0].stimulus_force, 0.5);
  for (int i = 1; i <= 30; ++i) bench.step(above(kHigh + 1e-4 * i));
  EXPECT_NEAR(bench.force().z(), bench.rows[0].stimulus_force, 1e-15);
  EXPECT_LT(bench.rows[0].stimulus_force, 0.4) << "0.5 N over 3 mm gives 1.5 mJ";
}

TEST(Stimulus, TheDutyLimitLowersIt) {
  GateLimits limits;
  limits.continuous_force = 1.0;
  GateState state;
  double squares = 0.0;
  double scale = 1.0;
  for (int i = 0; i < 240'000; ++i) {
    const GateOutput out = pass_gate(limits, state, {.stimulus = Vec3(3.0, 0.0, 0.0)});
    scale = out.stimulus_scale;
    if (i >= 120'000) squares += state.force.squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / 120'000), 1.0);
  EXPECT_NEAR(state.force.x(), 3.0 * scale, 1e-12);
  EXPECT_GT(state.force.x(), 0.85);
}

}  // namespace
}  // namespace palpate::haptics
