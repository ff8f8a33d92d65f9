#include "core/haptics/gate.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

constexpr double kGateInf = std::numeric_limits<double>::infinity();
constexpr double kGateNaN = std::numeric_limits<double>::quiet_NaN();

ForceCommand force_only(const Vec3& force) { return {force, Vec3::Zero(), 0.0}; }

/// The gate with a device that does not move.
GateOutput pass(const GateLimits& limits, GateState& state, const ForceCommand& tissue,
                const Vec3& noise = Vec3::Zero(), Fault fault = Fault::kNone) {
  return pass_gate(limits, state, {.tissue = tissue, .noise = noise, .fault = fault});
}

/// A gate that already writes this command.
GateState holding(const GateLimits& limits, const ForceCommand& command) {
  GateState state;
  for (int i = 0; i < 100; ++i) (void)pass(limits, state, command, Vec3::Zero(), Fault::kNone);
  return state;
}

TEST(Gate, WithinTheLimitsTissueForcePlusNoiseGoesThroughUnchanged) {
  GateState state;
  const ForceCommand tissue{Vec3(0.5, -1.0, 2.0), Vec3(0.01, 0.0, -0.02), 0.3};
  const Vec3 noise(0.01, 0.02, -0.03);
  const GateOutput out = pass({}, state, tissue, noise, Fault::kNone);
  EXPECT_EQ(out.command.force, Vec3(tissue.force + noise));
  EXPECT_EQ(out.command.torque, tissue.torque);
  EXPECT_EQ(out.command.gripper_force, 0.3);
  EXPECT_EQ(out.status, 0u);
}

TEST(Gate, ClampKeepsTheDirectionAndTakesTheNormToTheLimit) {
  GateLimits limits;
  limits.force_step = 100.0;
  limits.torque_step = 100.0;
  GateState state;
  const GateOutput out =
      pass(limits, state, {Vec3(0, 30, 40), Vec3(0.6, 0, 0.8), 0.0}, Vec3::Zero(), Fault::kNone);
  EXPECT_TRUE(out.command.force.isApprox(Vec3(0, 12, 16), 1e-12));
  EXPECT_TRUE(out.command.torque.isApprox(Vec3(0.12, 0, 0.16), 1e-12));
  EXPECT_EQ(out.status, kForceClamped | kTorqueClamped);
}

TEST(Gate, SlewMovesStraightTowardsTheWantedForceByOneStep) {
  GateLimits limits;
  GateState state = holding(limits, force_only(Vec3(3, 0, 0)));
  const GateOutput out = pass(limits, state, force_only(Vec3(3, 10, 0)), Vec3::Zero(), Fault::kNone);
  EXPECT_TRUE(out.command.force.isApprox(Vec3(3, 5, 0), 1e-12));
  EXPECT_EQ(out.status, kForceSlewed);
}

TEST(Gate, NoiseIsAddedBeforeTheClamp) {
  GateLimits limits;
  limits.force_step = 100.0;
  GateState state;
  const GateOutput out = pass(limits, state, force_only(Vec3(0, 0, 19.99)), Vec3(0, 0, 0.1), Fault::kNone);
  EXPECT_NEAR(out.command.force.z(), 20.0, 1e-12);
  EXPECT_EQ(out.status, kForceClamped);
}

TEST(Gate, NeverAboveTheLimitsWhateverComesIn) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0);
  GateLimits limits{7.3, 0.11, 0.31, 0.0017, 1e-3};
  GateState state;
  for (int i = 0; i < 200'000; ++i) {
    const double size = std::pow(10.0, exponent(random));
    const ForceCommand tissue{size * Vec3(unit(random), unit(random), unit(random)),
                              size * Vec3(unit(random), unit(random), unit(random)), size * unit(random)};
    const GateState before = state;
    const GateOutput out = pass(limits, state, tissue, Vec3(unit(random), 0, 0), Fault::kNone);
    ASSERT_LE(out.command.force.norm(), limits.max_force);
    ASSERT_LE(out.command.torque.norm(), limits.max_torque);
    ASSERT_LE(std::abs(out.command.gripper_force), limits.max_force);
    ASSERT_LE((out.command.force - before.force).norm(), limits.force_step * (1 + 1e-12));
    ASSERT_LE((out.command.torque - before.torque).norm(), limits.torque_step * (1 + 1e-12));
    ASSERT_LE(std::abs(out.command.gripper_force - before.gripper_force), limits.force_step * (1 + 1e-12));
  }
}

TEST(Gate, AForceThatIsNotFiniteLatchesAFaultAndNeverReachesTheHand) {
  for (const double bad : {kGateNaN, kGateInf, -kGateInf, 1e200}) {
    for (int place = 0; place < 4; ++place) {
      GateState state = holding({}, force_only(Vec3(0, 0, 4)));
      ForceCommand tissue = force_only(Vec3(0, 0, 4));
      Vec3 noise = Vec3::Zero();
      if (place == 0) tissue.force.x() = bad;
      if (place == 1) tissue.torque.y() = bad;
      if (place == 2) noise.z() = bad;
      if (place == 3) tissue.gripper_force = std::isfinite(bad) ? kGateNaN : bad;
      const GateOutput out = pass({}, state, tissue, noise, Fault::kNone);
      EXPECT_TRUE(out.command.force.allFinite());
      EXPECT_TRUE(out.command.torque.allFinite());
      EXPECT_TRUE(std::isfinite(out.command.gripper_force));
      EXPECT_LT(out.command.force.norm(), 4.0);
      EXPECT_EQ(state.fault, Fault::kNotFinite);
    }
  }
}

TEST(Gate, AFaultBringsTheForceLinearlyToZeroWithinTenMillisecondsAtAnyRate) {
  for (const double rate : {30.0, 100.0, 333.0, 1000.0, 3000.0, 4000.0, 10000.0}) {
    GateLimits limits;
    limits.period = 1.0 / rate;
    const ForceCommand steady{Vec3(0, 3, 4), Vec3(0.1, 0, 0), 2.0};
    GateState state = holding(limits, steady);
    double last = 5.0;
    double drop = -1.0;
    int ticks = 0;
    for (; last > 0.0; ++ticks) {
      const GateOutput out =
          pass(limits, state, steady, Vec3::Zero(), ticks == 0 ? Fault::kDevice : Fault::kNone);
      const double now = out.command.force.norm();
      if (drop < 0.0) drop = last - now;
      EXPECT_NEAR(last - now, drop, 1e-12) << rate;
      EXPECT_NEAR(out.command.torque.norm() * 50.0, now, 1e-12);
      EXPECT_NEAR(out.command.gripper_force * 2.5, now, 1e-12);
      last = now;
    }
    EXPECT_LE((ticks - 1) * limits.period, kFaultFall) << rate;
    EXPECT_GE(ticks * limits.period, kFaultFall - limits.period) << rate;
    for (int i = 0; i < 1000; ++i) {
      const GateOutput out = pass(limits, state, steady, Vec3(0.01, 0, 0), Fault::kNone);
      ASSERT_EQ(out.command.force, Vec3::Zero().eval());
      ASSERT_EQ(out.command.torque, Vec3::Zero().eval());
      ASSERT_EQ(out.command.gripper_force, 0.0);
    }
    EXPECT_EQ(state.fault, Fault::kDevice);
  }
}

TEST(Gate, ASecondFaultDoesNotStartTheFallAgain) {
  GateState state = holding({}, force_only(Vec3(0, 0, 5)));
  for (int i = 0; i < 10; ++i) (void)pass({}, state, force_only(Vec3(0, 0, 5)), Vec3::Zero(), Fault::kDevice);
  EXPECT_EQ(state.force, Vec3::Zero().eval());
  (void)pass({}, state, force_only(Vec3(0, 0, kGateNaN)), Vec3::Zero(), Fault::kNone);
  EXPECT_EQ(state.fault, Fault::kDevice) << "the first fault is kept";
}

TEST(Gate, AfterResetTheForceRisesAgainByTheSlewLimit) {
  GateState state = holding({}, force_only(Vec3(0, 0, 8)));
  for (int i = 0; i < 20; ++i) (void)pass({}, state, force_only(Vec3(0, 0, 8)), Vec3::Zero(), Fault::kDevice);
  reset_fault(state);
  EXPECT_EQ(state.fault, Fault::kNone);
  const GateOutput out = pass({}, state, force_only(Vec3(0, 0, 8)), Vec3::Zero(), Fault::kNone);
  EXPECT_NEAR(out.command.force.z(), 5.0, 1e-12);
}

TEST(Gate, ResetsInAStormDoNotSlowTheFallToZero) {
  const GateLimits limits;
  GateState state = holding(limits, force_only(Vec3(0, 0, 5)));
  for (int tick = 0; tick < 10; ++tick) {
    reset_fault(state);
    (void)pass(limits, state, force_only(Vec3(0, 0, 5)), Vec3::Zero(), Fault::kDevice);
  }
  EXPECT_EQ(state.force, Vec3(Vec3::Zero()));
}

TEST(Gate, AfterAResetAndAGoodTickAFaultTakesItsWholeFallAgain) {
  const GateLimits limits;
  GateState state = holding(limits, force_only(Vec3(0, 0, 5)));
  for (int tick = 0; tick < 5; ++tick) (void)pass(limits, state, {}, Vec3::Zero(), Fault::kDevice);
  reset_fault(state);
  (void)pass(limits, state, force_only(Vec3(0, 0, 5)));
  EXPECT_EQ(state.force.z(), 5.0);
  (void)pass(limits, state, {}, Vec3::Zero(), Fault::kDevice);
  EXPECT_NEAR(state.force.z(), 4.5, 1e-12);
}

/// Ticks of a constant force through the gate of a device with 1 N of continuous force.
struct Duty {
  GateLimits limits;
  GateState state;
  std::uint32_t status = 0;  // OR of all ticks
  double squares = 0.0;
  bool warm = false;  // warm motors

  Duty() { limits.continuous_force = 1.0; }
  void hold(double force, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      status |= pass_gate(limits, state, {.tissue = force_only(Vec3(0, force, 0)), .warm = warm}).status;
      squares += state.force.squaredNorm();
    }
  }
};

TEST(Duty, AForceThatTheDeviceBearsIsLeftAlone) {
  Duty duty;
  duty.hold(0.89, 300'000);
  EXPECT_EQ(duty.state.force.y(), 0.89);
  EXPECT_EQ(duty.status, 0U);
}

TEST(Duty, AShortPushIsLeftAlone) {
  Duty duty;
  duty.hold(3.0, 800);
  EXPECT_EQ(duty.state.force.y(), 3.0);
  EXPECT_EQ(duty.status, 0U);
}

TEST(Duty, WarnsWhenTheRmsOverTenSecondsIsAboveAndLowersTheForceWhenThatOverAMinuteIs) {
  Duty duty;
  duty.hold(3.0, 1500);
  EXPECT_EQ(duty.status, kDutyHigh) << "9 N^2 (1 - exp(-t/10 s)) is 1 N^2 after 1.18 s";
  EXPECT_EQ(duty.state.force.y(), 3.0);
  duty.hold(3.0, 4300);
  EXPECT_NE(duty.status & kDutyLimited, 0U) << "9 N^2 (1 - exp(-t/60 s)) is 0.81 N^2 after 5.66 s";
  duty.squares = 0.0;
  double before = duty.state.force.y();
  for (int i = 0; i < 120'000; ++i) {
    duty.hold(3.0, 1);
    ASSERT_LT(std::abs(duty.state.force.y() - before), 0.01) << "a ramp, no step";
    before = duty.state.force.y();
  }
  EXPECT_LT(std::sqrt(duty.squares / 120'000), 1.0);
  EXPECT_GT(duty.state.force.y(), 0.85) << "and what the device bears goes on";
}

TEST(Duty, WarmMotorsLowerTheForceWithinSecondsByARampAndItComesBackSlowly) {
  Duty duty;
  duty.hold(0.5, 1000);
  EXPECT_EQ(duty.status, 0U);
  duty.warm = true;
  double before = duty.state.force.y();
  for (int i = 0; i < 5000; ++i) {
    duty.hold(0.5, 1);
    ASSERT_LT(std::abs(duty.state.force.y() - before), 0.01) << "a ramp, no step";
    before = duty.state.force.y();
  }
  EXPECT_NE(duty.status & kDutyLimited, 0U);
  // The mean square approaches 1 N^2 with 1 s and decays with 60 s, so the RMS load settles at (60/61)^(1/2),
  // and the force at 10 (1 - 0.9918) of the tissue force.
  EXPECT_NEAR(duty.state.force.y(), 0.5 * 10.0 * (1.0 - std::sqrt(60.0 / 61.0)), 0.02);
  duty.warm = false;
  duty.hold(0.5, 60'000);
  EXPECT_EQ(duty.state.force.y(), 0.5);
}

TEST(Duty, OfADeviceWhoseContinuousForceNobodyKnowsNothingIsLowered) {
  Duty duty;
  duty.limits.continuous_force = DeviceAbilities::kUnknown;
  duty.hold(15.0, 200'000);
  EXPECT_EQ(duty.state.force.y(), 15.0);
}

}  // namespace
}  // namespace palpate::haptics
