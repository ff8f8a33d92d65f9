#include "core/haptics/passivity.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/haptics/gate.h"
#include "palpate/touch_noise.h"

namespace palpate::haptics {
namespace {

constexpr double kPassivityPeriod = 1e-3;

DeviceMotion moved(double x) { return {Vec3(x, 0.0, 0.0), Vec3::Zero()}; }

ForceCommand pushing(double x) { return {Vec3(x, 0.0, 0.0), Vec3::Zero(), 0.0}; }

TEST(Passivity, TheObserverBooksForceTimesWayAndTorqueTimesTurn) {
  PassivityObserver observer;
  observe_tissue(observer, {Vec3(-2.0, 0.0, 0.0), Vec3(0.0, 0.5, 0.0), 0.0}, Vec3::Zero(),
                 {Vec3(0.001, 0.0, 0.0), Vec3(0.0, -0.002, 0.0)});
  EXPECT_DOUBLE_EQ(observer.tissue, 0.002 + 0.001) << "against the force and the torque: put in";
  EXPECT_EQ(observer.noise, 0.0);
}

TEST(Passivity, NoiseHasItsOwnAccount) {
  PassivityObserver observer;
  observe_tissue(observer, pushing(-1.9), Vec3(0.1, 0.0, 0.0), moved(0.001));
  observe_noise(observer, Vec3(0.1, 0.0, 0.0), moved(0.001), kPassivityPeriod);
  EXPECT_DOUBLE_EQ(observer.tissue, 0.002) << "the tissue's part of the force was -2 N";
  EXPECT_DOUBLE_EQ(observer.noise, 1e-4);
}

TEST(Passivity, OutsideASurplusIsForgivenAndADeficitIsNot) {
  PassivityObserver observer{0.5, 0.1, 0.0};
  reset_surplus(observer);
  EXPECT_EQ(observer.tissue, 0.0);
  observer.tissue = -0.5;
  reset_surplus(observer);
  EXPECT_EQ(observer.tissue, -0.5);
  EXPECT_EQ(observer.noise, 0.1);
}

/// A deficit after ticks in which the hand moved by the same vector.
PassivityObserver in_deficit(double deficit, const DeviceMotion& recent) {
  PassivityObserver observer;
  observer.tissue = -deficit;
  observer.recent = recent;
  observer.way = recent.translation.squaredNorm();
  observer.turn = recent.rotation.squaredNorm();
  observer.way_kept = observer.way;
  observer.turn_kept = observer.turn;
  return observer;
}

TEST(Passivity, WithinTheLeewayNothingIsDone) {
  ForceCommand tissue = pushing(3.0);
  const DeviceMotion motion = moved(0.001);
  EXPECT_FALSE(control_passivity(in_deficit(kEnergyTolerance, motion), kPassivityPeriod, tissue));
  EXPECT_EQ(tissue.force.x(), 3.0);
}

TEST(Passivity, ADeficitIsDampedInTheNextTick) {
  const double deficit = 1e-4;  // J
  const double way = 2e-4;      // m per tick: 0.2 m/s
  ForceCommand tissue = {Vec3(0.0, 1.0, 0.0), Vec3::Zero(), 0.0};
  EXPECT_TRUE(control_passivity(in_deficit(deficit, moved(way)), kPassivityPeriod, tissue));
  EXPECT_NEAR(tissue.force.x(), -deficit / way, 1e-12) << "over the same way again it takes the deficit";
  EXPECT_DOUBLE_EQ(tissue.force.y(), 1.0) << "across the way no work is done";
}

TEST(Passivity, DampingIsBounded) {
  ForceCommand tissue;
  EXPECT_TRUE(control_passivity(in_deficit(1.0, moved(1e-5)), kPassivityPeriod, tissue));
  EXPECT_NEAR(tissue.force.x(), -kMaxDamping * 1e-5 / kPassivityPeriod, 1e-12);
  ForceCommand turned;
  const DeviceMotion turn{Vec3::Zero(), Vec3(0, 1e-5, 0)};
  EXPECT_TRUE(control_passivity(in_deficit(1.0, turn), kPassivityPeriod, turned));
  EXPECT_NEAR(turned.torque.y(), -kMaxAngularDamping * 1e-5 / kPassivityPeriod, 1e-15);
}

/// Deficit after 40 ms, over the one of 1 mJ before, of a hand that turns back from one motion to another.
double deficit_after_turn(const DeviceMotion& in, const DeviceMotion& out, double period) {
  PassivityObserver observer = in_deficit(1e-3, in);
  double most = 1e-3;
  const int ticks = static_cast<int>(std::lround(0.04 / period));
  for (int i = 0; i < ticks; ++i) {
    ForceCommand tissue;
    (void)control_passivity(observer, period, tissue);
    observe_tissue(observer, tissue, Vec3::Zero(), out);
    average_motion(observer, out, period);
    most = std::max(most, -observer.tissue);
  }
  return most / 1e-3;
}

// The average goes from 1 to 2 exp(-t / 5 ms) - 1 times the old motion. Until it is zero the deficit grows by
// the factor exp(5 (1 - ln 2)) = 4.6.
TEST(Passivity, WhereTheHandTurnsBackTheDamperGivesLittleAndSoonTakesIt) {
  EXPECT_LT(deficit_after_turn(moved(11e-3), moved(-1e-4), 1e-3), 2.0) << "a jump into the tissue";
  for (const double period : {1e-3, 1e-4}) {
    for (const double speed : {0.05, 0.2, 1.0}) {
      EXPECT_LT(deficit_after_turn(moved(speed * period), moved(-speed * period), period), 4.7)
          << speed << " m/s, " << period << " s";
    }
  }
}

TEST(Passivity, ADeviceThatStandsStillIsLeftAlone) {
  ForceCommand tissue = pushing(3.0);
  (void)control_passivity(in_deficit(1.0, {}), kPassivityPeriod, tissue);
  EXPECT_EQ(tissue.force.x(), 3.0);
}

TEST(Passivity, WhatAMovingOrganDoesOnAHandThatGoesAlongIsItsOwnAffair) {
  GateState state;
  state.energy.tissue = 1e-3;  // stored before
  (void)pass_gate({}, state, {.tissue = pushing(2.0)});
  for (int i = 0; i < 100; ++i) {
    const GateOutput out = pass_gate(
        {}, state, {.tissue = pushing(2.0), .motion = moved(1e-4), .organ = moved(1e-4), .controlled = true});
    EXPECT_EQ(out.status & kEnergyDamped, 0U);
    EXPECT_EQ(out.command.force.x(), 2.0);
  }
  EXPECT_NEAR(state.energy.tissue, 1e-3, 1e-15);
  (void)pass_gate({}, state,
                  {.tissue = pushing(2.0), .motion = {}, .organ = moved(1e-4), .controlled = true});
  EXPECT_NEAR(state.energy.tissue, 1.2e-3, 1e-15) << "pushed against a hand that stays, the tissue stores it";
}

/// Pushes a free mass with noise through the gate. @return largest energy [J] that the mass received
double given_by_noise(double sigma, double mass, int ticks, bool controlled) {
  noise::NoiseSettings settings;
  settings.gain = sigma * settings.threshold;
  const noise::TouchNoise source(settings, 1.0 / kPassivityPeriod);
  noise::TouchNoise::State level;
  GateState state;
  double speed = 0.0;
  double way = 0.0;
  double given = 0.0;
  double most = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const double force = source.force(level, true, 0, static_cast<std::uint64_t>(i), 0.0);
    const GateOutput out = pass_gate(
        {}, state, {.noise = Vec3(force, 0.0, 0.0), .motion = moved(way), .controlled = controlled});
    const double push = out.command.force.x();
    way = speed * kPassivityPeriod + 0.5 * push / mass * kPassivityPeriod * kPassivityPeriod;
    speed += push / mass * kPassivityPeriod;
    given += push * way;
    most = std::max(most, given);
  }
  return most;
}

TEST(Passivity, NoiseGivesNoMoreThanItsPowerAndTwiceItsLeeway) {
  constexpr int kTicks = 60'000;
  const double allowed = kNoisePower * kTicks * kPassivityPeriod + 2.0 * kNoiseEnergy;
  for (const double mass : {0.01, 0.02, 0.05}) {
    EXPECT_LE(given_by_noise(noise::kMaxSigma, mass, kTicks, true), allowed + 1e-4) << mass;
  }
  EXPECT_GT(given_by_noise(noise::kMaxSigma, 0.01, kTicks, false), 2.0 * allowed) << "the measure can fail";
}

TEST(Passivity, NoiseOfTheDefaultStrengthIsNeverTouched) {
  const double sigma = noise::NoiseSettings{}.gain / noise::NoiseSettings{}.threshold;
  EXPECT_EQ(given_by_noise(sigma, 0.05, 60'000, true), given_by_noise(sigma, 0.05, 60'000, false));
}

/// A mass thrown against a spring whose force comes a tick late, through the gate.
struct Bounce {
  bool controlled = false;
  double stiffness = 0.0;  // N/m
  double mass = 0.0;       // kg

  struct Result {
    double given = 0.0;         // J, largest net energy that the mass received
    double largest_tick = 0.0;  // J, largest energy exchanged in one tick
    double speed_at_end = 0.0;  // m/s, largest speed in the last quarter
  };

  [[nodiscard]] Result run(int ticks) const {
    GateState state;
    GateLimits limits;
    limits.force_step = 1e3;
    Result result;
    double x = 1e-3;  // m above the spring
    double speed = -0.1;
    double balance = 0.0;
    for (int i = 0; i < ticks; ++i) {
      const double before = x;
      x += speed * kPassivityPeriod + 0.5 * state.force.x() / mass * kPassivityPeriod * kPassivityPeriod;
      speed += state.force.x() / mass * kPassivityPeriod;
      const double work = state.force.x() * (x - before);
      balance += work;
      result.given = std::max(result.given, balance);
      result.largest_tick = std::max(result.largest_tick, std::abs(work));
      if (i > ticks * 3 / 4) result.speed_at_end = std::max(result.speed_at_end, std::abs(speed));
      // A second wall returns the mass to the spring.
      const double force = x < 0.0 ? -stiffness * x : (x > 2e-3 ? -stiffness * (x - 2e-3) : 0.0);
      (void)pass_gate(limits, state,
                      {.tissue = pushing(force), .motion = moved(x - before), .controlled = controlled});
    }
    return result;
  }
};

TEST(Passivity, WithTheControllerASampledSpringGivesNoMoreThanItGotButForTheStatedBound) {
  for (const double stiffness : {200.0, 1000.0, 1500.0}) {
    for (const double mass : {0.05, 0.1, 0.25}) {
      const Bounce::Result open = Bounce{false, stiffness, mass}.run(20'000);
      const Bounce::Result damped = Bounce{true, stiffness, mass}.run(20'000);
      const double bound = kEnergyTolerance + 2.0 * damped.largest_tick;
      EXPECT_LE(damped.given, bound) << stiffness << " N/m, " << mass << " kg";
      EXPECT_GT(open.given, 10.0 * bound) << "the same without the controller shows that it is needed";
      EXPECT_LT(damped.speed_at_end, open.speed_at_end);
    }
  }
}

TEST(Passivity, OnADeviceThatIsOnlyObservedNothingIsDamped) {
  GateState state;
  state.energy.tissue = -1.0;
  const GateInput input{.tissue = pushing(3.0), .motion = moved(1e-3), .controlled = false};
  const GateOutput out = pass_gate({}, state, input);
  EXPECT_EQ(out.command.force.x(), 3.0);
  EXPECT_EQ(out.status & kEnergyDamped, 0U);
}

TEST(Passivity, TheGateBooksWhatItWroteNotWhatWasAskedFor) {
  GateState state;
  GateLimits limits;  // 5 N per tick
  (void)pass_gate(limits, state, {.tissue = pushing(-8.0)});
  (void)pass_gate(limits, state, {.tissue = pushing(-8.0), .motion = moved(1e-3)});
  EXPECT_NEAR(state.energy.tissue, 5.0 * 1e-3, 1e-12);
}

// F^2 v / (2 s) is half of the surplus and 20 uJ: F = sqrt(E s / v), with v = 0.25 m/s and 0.5 rad/s.
TEST(Passivity, TheSlewReserveIsWhatTheSlewLimitCanTakeBack) {
  PassivityObserver observer;
  EXPECT_NEAR(slew_reserve(observer, 5000.0, 50.0).force, std::sqrt(20e-6 * 5000.0 / 0.25), 1e-12);
  observer.tissue = 1e-3;
  EXPECT_NEAR(slew_reserve(observer, 5000.0, 50.0).force, std::sqrt(1.02e-3 * 5000.0 / 0.25), 1e-12);
  EXPECT_NEAR(slew_reserve(observer, 5000.0, 50.0).torque, std::sqrt(1.02e-3 * 50.0 / 0.5), 1e-12);
  observer.tissue = -kEnergyTolerance;
  EXPECT_EQ(slew_reserve(observer, 5000.0, 50.0).force, 0.0);
  EXPECT_EQ(slew_reserve(observer, 5000.0, 50.0).torque, 0.0);
}

struct Returned {
  double given = 0.0;         // J, largest energy that the hand got
  double largest_tick = 0.0;  // J
  Fault fault = Fault::kNone;
};

/// A hand that presses a spring 8 mm deep and goes back, at two speeds [m/s], whatever the force.
Returned given_by_spring(double stiffness, double slew, double in, double out) {
  GateState state;
  GateLimits limits;
  limits.force_step = slew * kPassivityPeriod;
  double depth = 0.0;
  double given = 0.0;
  double most = 0.0;
  double largest_tick = 0.0;
  const auto pressed = static_cast<int>(8e-3 / (in * kPassivityPeriod));
  const int all = pressed + static_cast<int>(10e-3 / (out * kPassivityPeriod));
  for (int i = 0; i < all; ++i) {
    const double change = (i < pressed ? in : -out) * kPassivityPeriod;
    const double work = state.force.x() * -change;  // the force is outwards
    given += work;
    most = std::max(most, given);
    largest_tick = std::max(largest_tick, std::abs(work));
    depth = std::max(0.0, depth + change);
    (void)pass_gate(limits, state,
                    {.tissue = pushing(stiffness * depth), .motion = moved(-change), .controlled = true});
  }
  return {most, largest_tick, state.fault};
}

TEST(Passivity, AForceThatASmallSlewLimitHoldsUpGivesNoMoreThanTheBound) {
  for (const double stiffness : {45.0, 300.0, 900.0, 1900.0}) {
    for (const double slew : {1.0, 5.0, 10.0, 20.0, 100.0, 5000.0}) {  // N/s
      const Returned hand = given_by_spring(stiffness, slew, 0.067, 0.2);
      EXPECT_LE(hand.given, kEnergyTolerance + 2.0 * hand.largest_tick)
          << stiffness << " N/m, " << slew << " N/s";
    }
  }
}

// A fast press takes less energy than the depth holds, so the end of a slow withdrawal is in deficit.
TEST(Unstable, ASlowWithdrawalAfterAFastPressIsNot) {
  for (const double stiffness : {300.0, 900.0, 1900.0}) {
    for (const double in : {0.1, 0.3}) {
      for (const double out : {0.2e-3, 0.5e-3, 1e-3}) {
        const Returned hand = given_by_spring(stiffness, 5000.0, in, out);
        EXPECT_EQ(hand.fault, Fault::kNone) << stiffness << " N/m, " << in << " and " << out << " m/s";
        EXPECT_LE(hand.given, kEnergyTolerance + 2.0 * hand.largest_tick);
      }
    }
  }
}

// The organ moves away by a fraction of a sensor step in each tick, and the hand follows it. The steps are
// not farther apart than the controller's memory.
TEST(Passivity, WhereTheSensorsShowStepsTheDamperGivesNoEnergy) {
  constexpr double kSensorStep = 1e-5;
  for (const double period : {1e-3, 1e-4}) {
    for (const int ticks : {2, 3, 5, 10, 30}) {
      if (ticks * period > 1.01 * kMotionMemory) continue;
      GateState state;
      state.energy.tissue = -60e-6;
      GateLimits limits;
      limits.period = period;
      limits.force_step = 5000.0 * period;
      for (int i = 0; i < 10'000; ++i) {
        (void)pass_gate(limits, state,
                        {.motion = moved(i % ticks == 0 ? kSensorStep : 0.0),
                         .organ = moved(kSensorStep / ticks),
                         .controlled = true});
      }
      EXPECT_EQ(state.fault, Fault::kNone) << period << " s, a step in " << ticks << " ticks";
      EXPECT_GT(state.energy.tissue, -65e-6) << period << " s, a step in " << ticks << " ticks";
    }
  }
}

TEST(Passivity, TheAverageOfTheMotionLevelsStepsOfTheSensorsAndEndsAtZero) {
  for (const double period : {1e-2, 1e-3, 1e-4}) {
    PassivityObserver observer;
    // 10 um in ten ticks
    for (int i = 0; i < 2000; ++i) average_motion(observer, moved(i % 10 == 9 ? 1e-5 : 0.0), period);
    if (period > kMotionMemory) {
      EXPECT_EQ(observer.recent.translation.x(), 1e-5) << "a slow loop sees each tick";
    } else {
      EXPECT_NEAR(observer.recent.translation.x(), 1e-6, 1.5e-6) << period;
    }
    for (int i = 0; i < 5000; ++i) average_motion(observer, moved(0.0), period);
    EXPECT_EQ(observer.recent.translation.x(), 0.0);
  }
}

/// A hand that comes back to a spring in a deficit, at a speed [m/s]. @return depth at which it feels 1 N [m]
double depth_of_one_newton(double stiffness, double deficit, double speed) {
  GateState state;
  state.energy.tissue = -deficit;
  double depth = 0.0;
  while (depth < 0.02 && state.force.x() < 1.0) {
    depth += speed * kPassivityPeriod;
    (void)pass_gate({}, state,
                    {.tissue = pushing(stiffness * depth),
                     .motion = moved(-speed * kPassivityPeriod),
                     .controlled = true});
  }
  return depth;
}

TEST(Passivity, AHandThatPressesInADeficitPaysItAndFeelsTheTissueAgain) {
  for (const double stiffness : {300.0, 1000.0}) {
    for (const double speed : {0.01, 0.05, 0.2}) {
      EXPECT_LT(depth_of_one_newton(stiffness, 30e-6, speed), 1.0 / stiffness + 1.5e-3)
          << stiffness << " N/m, " << speed << " m/s";
    }
  }
}

TEST(Passivity, TheReserveLeavesTissueOfAnyOrganAsItIs) {
  GateState state;
  double depth = 0.0;
  for (int i = 0; i < 150; ++i) {
    depth += 1e-4;  // 0.1 m/s
    const GateOutput out =
        pass_gate({}, state, {.tissue = pushing(1200.0 * depth), .motion = moved(-1e-4), .controlled = true});
    ASSERT_DOUBLE_EQ(out.command.force.x(), 1200.0 * depth) << i;
  }
}

TEST(Unstable, WhenTheControllerActsWithoutAPause) {
  PassivityObserver observer;
  const auto after = [&](double seconds) {
    observer.damped_share = 0.0;
    for (int i = 0; i < std::lround(seconds / kPassivityPeriod); ++i) {
      observe_control(observer, true, kPassivityPeriod);
    }
    return is_unstable(observer);
  };
  const double time = -kDampedMemory * std::log(1.0 - kUnstableShare);
  EXPECT_FALSE(after(0.98 * time));
  EXPECT_TRUE(after(1.02 * time));
  observe_control(observer, false, kPassivityPeriod);
  EXPECT_LT(observer.damped_share, kUnstableShare + 0.02) << "a pause lowers it";
}

TEST(Unstable, WhenTheDeficitIsBeyondTheBound) {
  PassivityObserver observer;
  observer.largest_tick = 30e-6;
  observer.tissue = -(kEnergyTolerance + 60e-6 + 0.99 * kUnstableEnergy);
  EXPECT_FALSE(is_unstable(observer));
  observer.tissue = -(kEnergyTolerance + 60e-6 + 1.01 * kUnstableEnergy);
  EXPECT_TRUE(is_unstable(observer));
}

TEST(Unstable, TheGateRemembersTheLargestEnergyOfATick) {
  GateState state;
  state.force = Vec3(2.0, 0.0, 0.0);
  (void)pass_gate({}, state, {.motion = moved(-1e-3)});
  EXPECT_DOUBLE_EQ(state.energy.largest_tick, 2e-3);
  (void)pass_gate({}, state, {.motion = moved(0.0)});
  EXPECT_DOUBLE_EQ(state.energy.largest_tick, 2e-3);
}

TEST(Unstable, AHeldDeviceLatchesItAndAnObservedOneDoesNot) {
  for (const bool controlled : {true, false}) {
    GateState state;
    state.energy.tissue = -1.0;
    (void)pass_gate({}, state, {.tissue = pushing(1.0), .controlled = controlled});
    EXPECT_EQ(state.fault, controlled ? Fault::kUnstable : Fault::kNone);
  }
}

TEST(Unstable, TheForceFadesWithinFiftyMillisecondsAndNeverGivesEnergy) {
  for (const double speed : {-0.1, -1e-3, 0.0, 1e-3, 0.1}) {
    GateState state;
    state.force = Vec3(4.0, 3.0, 0.0);
    state.torque = Vec3(0.1, 0.0, 0.0);
    state.energy.tissue = -1.0;
    const DeviceMotion motion{Vec3(speed * kPassivityPeriod, 0.0, 0.0), Vec3(0.0, 1e-4, 0.0)};
    double before = state.force.norm();
    for (int tick = 1; tick <= 60; ++tick) {
      const GateOutput out =
          pass_gate({}, state, {.tissue = pushing(5.0), .motion = motion, .controlled = true});
      ASSERT_EQ(state.fault, Fault::kUnstable);
      EXPECT_LE(out.command.force.dot(motion.translation), 1e-15) << speed << " m/s, tick " << tick;
      EXPECT_LE(out.command.torque.dot(motion.rotation), 1e-15);
      EXPECT_LE(out.command.force.norm(), before + 1e-15) << "it does not rise again";
      before = out.command.force.norm();
      if (tick >= 50) {
        EXPECT_EQ(out.command.force, Vec3::Zero()) << tick;
        EXPECT_EQ(out.command.torque, Vec3::Zero());
      }
    }
  }
}

TEST(Unstable, AnotherFaultDuringTheFadeEndsItWithinTenMilliseconds) {
  GateState state;
  state.force = Vec3(4.0, 0.0, 0.0);
  state.energy.tissue = -1.0;
  (void)pass_gate({}, state, {.controlled = true});
  for (int tick = 0; tick < 10; ++tick) {
    (void)pass_gate({}, state, {.controlled = true, .fault = Fault::kDevice});
  }
  EXPECT_EQ(state.force, Vec3::Zero());
  EXPECT_EQ(state.fault, Fault::kUnstable) << "the first cause stays";
}

TEST(Unstable, WhatGivesEnergyIsGoneWithinTenMillisecondsAtAnySlewLimit) {
  GateState state;
  state.force = Vec3(12.0, 16.0, 0.0);
  state.energy.tissue = -1.0;
  GateLimits limits;
  limits.force_step = 1e-3;
  for (int tick = 1; tick <= 20; ++tick) {
    const GateOutput out = pass_gate(limits, state, {.motion = moved(1e-4), .controlled = true});
    if (tick >= 10) {
      EXPECT_LE(out.command.force.x(), 1e-12) << tick;
    }
  }
}

TEST(Unstable, TheLargestTickOfAnEarlierTouchDoesNotCount) {
  GateState state;
  state.energy.largest_tick = 1.0;
  (void)pass_gate({}, state, {.outside = true, .controlled = true});
  EXPECT_EQ(state.energy.largest_tick, 0.0);
  state.energy.largest_tick = 1.0;
  state.energy.tissue = -1e-3;
  (void)pass_gate({}, state, {.outside = true, .controlled = true});
  EXPECT_EQ(state.energy.largest_tick, 1.0) << "its deficit is still owed";
}

TEST(Unstable, AStalledLoopDuringTheFadeEndsItAtOnce) {
  GateState state;
  state.force = Vec3(4.0, 0.0, 0.0);
  state.energy.tissue = -1.0;
  (void)pass_gate({}, state, {.controlled = true});
  EXPECT_NE(state.force.x(), 0.0);
  (void)pass_gate({}, state, {.controlled = true, .fault = Fault::kStalled});
  EXPECT_EQ(state.force, Vec3::Zero());
}

TEST(Unstable, AResetForgetsTheDeficit) {
  GateState state;
  state.energy.tissue = -1.0;
  (void)pass_gate({}, state, {.controlled = true});
  reset_fault(state);
  EXPECT_EQ(state.energy.tissue, 0.0);
  (void)pass_gate({}, state, {.controlled = true});
  EXPECT_EQ(state.fault, Fault::kNone);
}

// The force must fall by 6 N across the motion and damp along it, in one tick of 5 N.
TEST(Passivity, WithinTheSlewLimitDissipationComesFirst) {
  GateState state;
  state.force = Vec3(0.0, 0.0, 6.0);
  state.energy.tissue = -60e-6;
  state.energy.largest_tick = 1.0;  // within the bound
  const DeviceMotion motion = moved(1e-3);
  state.energy.recent = motion;
  const ForceCommand tissue{Vec3(-0.01, 0.0, -4.0), Vec3::Zero(), 0.0};
  GateLimits limits;
  const GateOutput out = pass_gate(limits, state, {.tissue = tissue, .motion = motion, .controlled = true});
  // 60 uJ over 1 mm. The slew limit alone would leave 5 / 6 of it.
  EXPECT_LE(out.command.force.x(), -0.06);
  EXPECT_LE((out.command.force - Vec3(0.0, 0.0, 6.0)).norm(), limits.force_step);
}

}  // namespace
}  // namespace palpate::haptics
