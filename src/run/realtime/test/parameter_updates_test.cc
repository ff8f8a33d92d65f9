#include "palpate/parameter_updates.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/haptics/prepared_update.h"
#include "core/haptics/test/test_world.h"
#include "palpate/error.h"
#include "run/realtime/loop.h"

namespace palpate::realtime {
namespace {

using haptics::test::block_and_balls;
using haptics::test::no_noise;
using haptics::test::pressing;
using ::testing::HasSubstr;

model::TissueParameters gallbladder() { return model::tissue_preset("gallbladder"); }

/// The gallbladder with twice the stiffness in every layer: the force at any depth is twice as large.
model::TissueParameters twice_as_stiff() {
  model::TissueParameters tissue = gallbladder();
  tissue.k1 *= 2.0;
  return tissue;
}

/// Runs `ticks` offline presses. It calls `offer` before the device is read at each tick.
template <typename Offer>
std::vector<haptics::TickRow> run(const haptics::SimulationWorld& world, std::uint64_t ticks,
                                  haptics::ParameterUpdates& changes, const Offer& offer) {
  haptics::SimulationState state(world);
  // The loop checks for updates before it reads the device. An update offered at a tick takes effect at the
  // next tick.
  haptics::test::FakeDevice device([&](std::uint64_t tick, double time) {
    offer(tick);
    return pressing(time);
  });
  haptics::Device* const devices[] = {&device};
  haptics::test::RowKeeper rows(ticks);
  haptics::RunControl control(&changes);
  (void)run_loop(world, state, devices, {&rows}, {.ticks = ticks, .offline = true, .control = &control});
  return rows.rows;
}

std::string refusal_of(haptics::ParameterUpdates& changes, const model::TissueParameters& tissue) {
  try {
    (void)changes.offer(tissue);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ParameterUpdates, AContactKeepsItsDepthAndTheNewLawGivesTheForce) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0, no_noise());
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  const std::vector<haptics::TickRow> rows = run(world, 700, changes, [&](std::uint64_t tick) {
    if (tick == 599) (void)changes.offer(twice_as_stiff());
  });
  const haptics::TickRow& before = rows[599];
  const haptics::TickRow& after = rows[600];
  EXPECT_NEAR(before.depth, 5e-3, 0.1e-3);
  EXPECT_EQ(after.depth, before.depth);
  EXPECT_NEAR(after.tissue_force, 2.0 * before.tissue_force, 1e-12);
  EXPECT_EQ(before.events, 0u);
  EXPECT_EQ(after.events, haptics::kParameterUpdated);
  EXPECT_EQ(rows[601].events, 0u);
}

TEST(ParameterUpdates, TheGatesSlewLimitKeepsTheHandFromAJump) {
  haptics::SimulationWorld world = block_and_balls(1, 1000.0, no_noise());
  world.limits.force_step = 0.01;
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  const std::vector<haptics::TickRow> rows = run(world, 700, changes, [&](std::uint64_t tick) {
    if (tick == 599) (void)changes.offer(twice_as_stiff());
  });
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_LE(std::abs(rows[i].force[2] - rows[i - 1].force[2]), 0.01 + 1e-12) << i;
  }
  EXPECT_NEAR(rows.back().force[2], rows.back().tissue_force, 1e-9) << "it is reached in the end";
}

TEST(ParameterUpdates, OneIsTakenATickInTheOrderOffered) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0, no_noise());
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  for (int i = 1; i <= 3; ++i) {
    model::TissueParameters tissue = gallbladder();
    tissue.k1 *= i;
    EXPECT_EQ(changes.offer(tissue).number, static_cast<std::uint64_t>(i));
  }
  haptics::SimulationState state(world);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    const haptics::PreparedUpdate* change = changes.waiting(0);
    ASSERT_NE(change, nullptr);
    EXPECT_EQ(change->values.tissue.k1, gallbladder().k1 * static_cast<double>(i));
    haptics::apply_update(world, state, *change);
    EXPECT_EQ(state.change, i);
    changes.taken();
  }
  EXPECT_EQ(changes.waiting(0), nullptr);
}

/// The ticks that took an update.
std::vector<std::uint64_t> ticks_with_an_update(const std::vector<haptics::TickRow>& rows) {
  std::vector<std::uint64_t> ticks;
  for (const haptics::TickRow& row : rows) {
    if ((row.events & haptics::kParameterUpdated) != 0) ticks.push_back(row.tick);
  }
  return ticks;
}

TEST(ParameterUpdates, ATimedUpdateIsTakenExactlyAtItsTickAndALateOneAtTheNext) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0, no_noise());
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  const std::vector<haptics::TickRow> rows = run(world, 700, changes, [&](std::uint64_t tick) {
    if (tick == 10) (void)changes.offer(twice_as_stiff(), 600);
    if (tick == 650) (void)changes.offer(gallbladder(), 640);
  });
  EXPECT_THAT(ticks_with_an_update(rows), testing::ElementsAre(600, 651));
  EXPECT_EQ(rows[600].depth, rows[599].depth);
  EXPECT_NEAR(rows[600].tissue_force, 2.0 * rows[599].tissue_force, 1e-12);
  EXPECT_NEAR(rows[651].tissue_force, rows[599].tissue_force, 1e-12);
}

TEST(ParameterUpdates, ALaterUpdateWaitsBehindATimedOne) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  (void)changes.offer(haptics::LiveNoise{false, 1e-5, 4e-3}, 100);
  (void)changes.offer(twice_as_stiff());
  (void)changes.offer(haptics::LiveStimulus{0.1, 50e-3, 1}, 50);
  (void)changes.offer(haptics::LiveStimulus{0.0, 50e-3, 0}, 200);
  const std::vector<haptics::TickRow> rows = run(world, 300, changes, [](std::uint64_t) {});
  EXPECT_THAT(ticks_with_an_update(rows), testing::ElementsAre(100, 101, 102, 200));
  EXPECT_EQ(rows[101].events, haptics::kParameterUpdated);
  EXPECT_EQ(rows[102].events, haptics::kParameterUpdated | haptics::kIntervalBegan);
  EXPECT_EQ(rows[151].stimulus_force, 0.1) << "50 ticks, from 102 on";
  EXPECT_LT(rows[150].stimulus_force, 0.1);
  EXPECT_EQ(rows[200].events, haptics::kParameterUpdated | haptics::kIntervalEnded);
}

TEST(ParameterUpdates, SwitchedNoiseAndItsNewGainAreFullWithinFiftyMilliseconds) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  const haptics::LiveNoise stronger{true, 4.0 * world.noise.settings().gain,
                                    2.0 * world.noise.settings().threshold};
  haptics::apply_update(world, state,
                        haptics::prepare_update(world, haptics::parameter_update(gallbladder(), stronger,
                                                                                 haptics::kNoiseChanged)));
  std::vector<haptics::DeviceState> samples(1);
  std::vector<haptics::ForceCommand> commands(1);
  std::vector<haptics::TickRow> rows(1);
  double before = world.noise.sigma(0.0);
  for (std::uint64_t number = 0; number < 50; ++number) {
    samples[0] = pressing(0.0);
    haptics::tick(world, state, number, samples, commands, rows);
    const double sigma = state.touch_noise.sigma(0.0);
    ASSERT_GT(sigma, before) << number;
    ASSERT_LT(sigma, before * 1.1) << number;
    before = sigma;
  }
  EXPECT_EQ(state.touch_noise.settings().gain, stronger.gain);
  EXPECT_EQ(state.touch_noise.settings().threshold, stronger.threshold);

  haptics::apply_update(
      world, state,
      haptics::prepare_update(
          world, haptics::parameter_update(gallbladder(), {.enabled = false}, haptics::kNoiseChanged)));
  for (std::uint64_t number = 50; number < 100; ++number) {
    ASSERT_NEAR(state.noise[0].level, (100.0 - static_cast<double>(number)) / 50.0, 1e-9) << number;
    haptics::tick(world, state, number, samples, commands, rows);
  }
  EXPECT_EQ(rows[0].noise_force, 0.0);
}

TEST(ParameterUpdates, ATissueChangeLeavesTheNoiseAndTheOtherWayRound) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  (void)changes.offer(haptics::LiveNoise{false, 1e-5, 4e-3});
  (void)changes.offer(twice_as_stiff());
  EXPECT_EQ(changes.noise(), (haptics::LiveNoise{false, 1e-5, 4e-3}));
  EXPECT_EQ(changes.tissue().k1, 36.0);
  haptics::SimulationState state(world);
  haptics::apply_update(world, state, *changes.waiting(0));
  changes.taken();
  const haptics::NoiseCrossfade glide = state.noise_crossfade;
  EXPECT_EQ(changes.waiting(0)->values.noise.gain, 1e-5) << "each states all that is in force";
  haptics::apply_update(world, state, *changes.waiting(0));
  EXPECT_EQ(state.noise_crossfade.ticks_left, glide.ticks_left);
  EXPECT_FALSE(state.noise_enabled);
}

TEST(ParameterUpdates, BadValuesAreRefusedInWordsAndChangeNothing) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  model::TissueParameters bad = gallbladder();
  bad.k1 = -1.0;
  EXPECT_THAT(refusal_of(changes, bad), HasSubstr("k1_N_per_m"));
  bad = gallbladder();
  bad.beta = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of(changes, bad), HasSubstr("beta"));
  EXPECT_THROW(changes.offer(haptics::LiveNoise{true, 1.0, 5e-3}), ParameterError)
      << "200 N of sigma in contact";
  bad = gallbladder();
  bad.relaxation = {{0.5, 1.0}, {0.5, 2.0}};
  EXPECT_THAT(refusal_of(changes, bad), HasSubstr("relaxation"));
  bad = gallbladder();
  bad.contact.reference_radius = 5e-3;
  EXPECT_THAT(refusal_of(changes, bad),
              HasSubstr("reference_radius_mm = 5 mm: the organ was prepared for 10 mm"));
  EXPECT_THROW((void)changes.offer(haptics::LiveNoise{true, -1.0, 5e-3}), ParameterError);
  EXPECT_THROW((void)changes.offer(haptics::LiveNoise{true, 5e-5, 0.0}), ParameterError);
  haptics::ParameterUpdate unknown_law =
      haptics::parameter_update(gallbladder(), {}, haptics::kTissueChanged);
  unknown_law.tissue.law = static_cast<model::LawKind>(7);
  EXPECT_THROW((void)haptics::prepare_update(world, unknown_law), ParameterError);
  EXPECT_EQ(changes.waiting(0), nullptr);
  EXPECT_EQ(changes.tissue().k1, gallbladder().k1);
}

TEST(ParameterUpdates, NoMoreThanThirtyTwoWaitAndTheNextIsRefused) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  for (std::size_t i = 0; i < haptics::ParameterUpdates::kMaxWaiting; ++i) (void)changes.offer(gallbladder());
  EXPECT_THAT(refusal_of(changes, twice_as_stiff()), HasSubstr("has not taken the last 32 changes"));
  EXPECT_EQ(changes.tissue().k1, gallbladder().k1);
  changes.taken();
  EXPECT_EQ(changes.offer(twice_as_stiff()).number, 33u);
}

TEST(ParameterUpdates, WarningsOfTheNewTissueComeBackToTheCaller) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(
      world, gallbladder(), [](const model::TissueParameters& tissue, const auto& /*inclusions*/) {
        return tissue.k1 > 20.0 ? std::vector<std::string>{"too stiff"} : std::vector<std::string>{};
      });
  EXPECT_THAT(changes.offer(gallbladder()).warnings, testing::IsEmpty());
  EXPECT_THAT(changes.offer(twice_as_stiff()).warnings, testing::ElementsAre("too stiff"));
}

TEST(ParameterUpdates, ATissueMakesTheRoundTripThroughPlainDataBitForBit) {
  model::TissueParameters tissue = gallbladder();
  tissue.name = "soft \"one\"";
  tissue.law = model::LawKind::kSmooth;
  tissue.relaxation = {{0.1 + 0.2, 1.0 / 3.0}, {1e-3, 70.0}};
  tissue.contact.tangential_stiffness = 100.0 / 3.0;
  const haptics::LiveNoise noise{true, 1e-5 / 3, 5e-3 / 7};
  const haptics::ParameterUpdate change =
      haptics::parameter_update(tissue, noise, haptics::kTissueChanged | haptics::kNoiseChanged);
  EXPECT_EQ(change.noise, noise);
  EXPECT_EQ(change.tissue, tissue.numbers());
  EXPECT_EQ(haptics::tissue_of(change).name, tissue.name);
  EXPECT_EQ(haptics::parameter_update(haptics::tissue_of(change), noise, change.what), change);
  tissue.source = model::SourceParameters{"ball", 3e-3};
  EXPECT_FALSE(haptics::tissue_of(haptics::parameter_update(tissue, noise, 0)).source.has_value());
  tissue.size_exponent = 0.5;
  EXPECT_EQ(haptics::tissue_of(haptics::parameter_update(tissue, noise, 0)).source->radius, 3e-3)
      << "the exponent needs it";
  tissue.contact.tangential_stiffness.reset();
  EXPECT_FALSE(haptics::tissue_of(haptics::parameter_update(tissue, noise, 0))
                   .contact.tangential_stiffness.has_value());
}

TEST(ParameterUpdates, OffersOfSeveralThreadsAllArriveOnce) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::ParameterUpdates changes(world, gallbladder(), {});
  constexpr int kEach = 100;
  const auto offer_all = [&] {
    for (int done = 0; done < kEach;) {
      try {
        (void)changes.offer(twice_as_stiff());
        ++done;
      } catch (const InputError&) {
        std::this_thread::yield();  // 32 updates wait already
      }
    }
  };
  std::thread one(offer_all);
  std::thread other(offer_all);
  for (std::uint64_t taken = 0; taken < 2 * kEach;) {
    const haptics::PreparedUpdate* change = changes.waiting(0);
    if (change == nullptr) {
      std::this_thread::yield();
      continue;
    }
    EXPECT_EQ(change->values.number, ++taken);
    changes.taken();
  }
  one.join();
  other.join();
  EXPECT_EQ(changes.waiting(0), nullptr);
}

}  // namespace
}  // namespace palpate::realtime
