#include "run/devices/hand_mass.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate::devices {
namespace {

constexpr double kPeriod = 1e-3;  // s
const Vec3 kNowhere = Vec3::Zero();

/// A mass of 0.25 kg without any spring, damping or friction.
HandMassParameters free_mass() { return {0.25, 0.0, 0.0, 0.0, 0.0}; }

void push(HandMass& hand, const Vec3& force, double seconds) {
  const auto periods = std::lround(seconds / kPeriod);
  for (long i = 0; i < periods; ++i) hand.advance(kNowhere, kNowhere, force, kPeriod);
}

TEST(HandMass, FallsFreelyUnderAConstantForce) {
  HandMass hand(free_mass(), kNowhere);
  push(hand, Vec3(0, 0, -1.0), 1.0);
  // v = F t / m. The implicit step is ahead of F t^2 / (2 m) by half a step at the final speed.
  EXPECT_NEAR(hand.velocity().z(), -4.0, 1e-9);
  EXPECT_NEAR(hand.position().z(), -(2.0 + 0.5 * HandMass::kLongestStep * 4.0), 1e-9);
}

TEST(HandMass, ApproachesTheTerminalSpeedOfItsDamping) {
  HandMassParameters parameters = free_mass();
  parameters.damping = 2.0;
  HandMass hand(parameters, kNowhere);
  push(hand, Vec3(0.5, 0, 0), 0.125);  // one time constant, m / b
  EXPECT_NEAR(hand.velocity().x(), 0.25 * (1.0 - std::exp(-1.0)), 1e-4);
  push(hand, Vec3(0.5, 0, 0), 2.0);
  EXPECT_NEAR(hand.velocity().x(), 0.25, 1e-6);
}

TEST(HandMass, SticksExactlyBelowItsFrictionAndSlidesAboveIt) {
  HandMassParameters parameters = free_mass();
  parameters.friction = 0.05;
  HandMass hand(parameters, Vec3(1, 2, 3));
  push(hand, Vec3(0.03, -0.03, 0.02), 1.0);  // norm 0.0469 N
  EXPECT_EQ(hand.position(), Vec3(1, 2, 3));
  EXPECT_EQ(hand.velocity(), kNowhere);
  push(hand, Vec3(0.04, 0.0, 0.04), 1.0);  // each component is below the friction, the norm 0.0566 N above
  EXPECT_NEAR(hand.velocity().norm(), (std::sqrt(0.0032) - 0.05) / 0.25, 1e-9);
}

TEST(HandMass, FrictionAloneStopsASlidingMassAfterTheWayOfItsEnergy) {
  HandMassParameters parameters = free_mass();
  parameters.friction = 0.2;
  HandMass hand(parameters, kNowhere);
  push(hand, Vec3(0, 1.0, 0), 0.1);
  const double speed = hand.velocity().y();
  EXPECT_NEAR(speed, 0.8 / 0.25 * 0.1, 1e-9);
  const double start = hand.position().y();
  push(hand, kNowhere, 1.0);
  EXPECT_NEAR(hand.position().y() - start, 0.25 * speed * speed / (2.0 * 0.2), 1e-4);
  const Vec3 rest = hand.position();
  EXPECT_EQ(hand.velocity(), kNowhere);
  push(hand, kNowhere, 1.0);
  EXPECT_EQ(hand.position(), rest);
}

TEST(HandMass, SwingsAndDecaysAsASpringDamperDoes) {
  constexpr double kMass = 0.25;
  constexpr double kStiffness = 500.0;
  constexpr double kGripDamping = 5.0;
  constexpr double kStart = 10e-3;
  const double omega = std::sqrt(kStiffness / kMass);
  const double zeta = kGripDamping / (2.0 * std::sqrt(kStiffness * kMass));
  const double damped = omega * std::sqrt(1.0 - zeta * zeta);
  HandMass hand({kMass, 0.0, 0.0, kStiffness, kGripDamping}, Vec3(kStart, 0, 0));
  for (int i = 1; i <= 500; ++i) {
    push(hand, kNowhere, kPeriod);
    const double t = i * kPeriod;
    const double expected =
        kStart * std::exp(-zeta * omega * t) *
        (std::cos(damped * t) + zeta / std::sqrt(1.0 - zeta * zeta) * std::sin(damped * t));
    ASSERT_NEAR(hand.position().x(), expected, 0.005 * kStart) << t;
  }
}

TEST(HandMass, ComesToRestWhereTheGripBalancesTheForce) {
  HandMass hand({0.25, 1.0, 0.0, 50.0, 1.0}, kNowhere);
  push(hand, Vec3(0, 0, 0.4), 10.0);
  EXPECT_NEAR(hand.position().z(), 0.4 / 50.0, 1e-9);
}

TEST(HandMass, TheForcesWorkIsKineticEnergyWhereNothingElseActs) {
  HandMass hand(free_mass(), kNowhere);
  push(hand, Vec3(0.3, -0.4, 1.2), 0.5);
  const double kinetic = 0.5 * 0.25 * hand.velocity().squaredNorm();
  EXPECT_NEAR(hand.work_of_force(), kinetic, 2e-4 * kinetic);  // half a step of 50 us in 0.5 s
}

TEST(HandMass, NoStiffnessDampingOrFrictionMakesItsStepsUnstable) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e9}) {
    for (const double friction : {0.0, 1.0, 1e3}) {
      HandMass hand({1e-3, 1e3, friction, stiffness, 1e4}, Vec3(0.1, 0, 0));
      push(hand, kNowhere, 1.0);
      ASSERT_LE(hand.position().norm(), 0.1) << stiffness << " N/m, " << friction << " N";
    }
  }
}

TEST(HandMass, APeriodIsCutIntoStepsOfNoMoreThanFiftyMicroseconds) {
  // Free fall through one period T in n steps: F/m T^2 (1 + 1/n) / 2.
  for (const auto& [period, steps] :
       {std::pair(1e-3, 20.0), std::pair(0.25e-3, 5.0), std::pair(0.11e-3, 3.0)}) {
    HandMass hand({1.0, 0.0, 0.0, 0.0, 0.0}, kNowhere);
    hand.advance(kNowhere, kNowhere, Vec3(1, 0, 0), period);
    EXPECT_NEAR(hand.position().x() / (0.5 * period * period), 1.0 + 1.0 / steps, 1e-9);
  }
}

}  // namespace
}  // namespace palpate::devices
