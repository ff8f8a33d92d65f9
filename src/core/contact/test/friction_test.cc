// Friction of one contact: spring, damper and cone, for random slips.
#include <algorithm>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "core/contact/proxy.h"
#include "core/contact/test/rig.h"

namespace palpate::contact::test {
namespace {

/// A contact with random slip, normal and normal force, and the tool's motion there in one tick.
struct RandomSlip {
  Vec3 normal;
  FrictionSpring spring;
  double normal_force;
  Vec3 motion;

  explicit RandomSlip(std::mt19937& random) {
    std::normal_distribution<double> draw;
    const auto vector = [&](double size) -> Vec3 {
      return size * Vec3(draw(random), draw(random), draw(random));
    };
    normal = vector(1.0).normalized();
    const Vec3 slip = vector(1e-3);
    spring = FrictionSpring(slip - slip.dot(normal) * normal);
    normal_force = std::max(0.0, draw(random));
    motion = vector(0.1e-3);
  }
};

/// Laws of a tissue with random friction and tangential stiffness. @param damping tangential [N s/m]
TissueLaws random_laws(std::mt19937& random, double damping) {
  std::uniform_real_distribution<double> share(0.1, 1.0);
  model::TissueParameters tissue = plain_tissue();
  tissue.contact.friction = share(random);
  tissue.contact.tangential_stiffness = 1000.0 * share(random);
  tissue.contact.tangential_damping = damping;
  return TissueLaws(tissue, 1e-3);
}

TEST(Friction, WithoutDampingIsTheSpringTrimmedToTheConeBitForBit) {
  std::mt19937 random(3);
  int sliding = 0;
  for (int i = 0; i < 2000; ++i) {
    const TissueLaws laws = random_laws(random, 0.0);
    RandomSlip trial(random);
    Vec3 slip = trial.spring.slip() + trial.motion;
    slip -= slip.dot(trial.normal) * trial.normal;
    const double longest = laws.friction * trial.normal_force / laws.tangential_stiffness;
    const double length = slip.norm();
    if (length > longest) slip *= longest / length;
    sliding += length > longest ? 1 : 0;
    const Vec3 friction = trial.spring.stretch(1e-3, laws, trial.motion, trial.normal, trial.normal_force);
    const Vec3 force = -laws.tangential_stiffness * slip;
    ASSERT_EQ(std::memcmp(trial.spring.slip().data(), slip.data(), sizeof slip), 0) << i;
    ASSERT_EQ(std::memcmp(friction.data(), force.data(), sizeof force), 0) << i;
  }
  EXPECT_GT(sliding, 200);
  EXPECT_LT(sliding, 1800);
}

TEST(Friction, WithDampingIsOnTheConeOrInsideAndTakesAtLeastWhatItsSpringGains) {
  std::mt19937 random(4);
  int sliding = 0;
  for (int i = 0; i < 2000; ++i) {
    const double damping = std::uniform_real_distribution<double>(0.01, 20.0)(random);
    const TissueLaws laws = random_laws(random, damping);
    RandomSlip trial(random);
    const Vec3 before = trial.spring.slip();
    const Vec3 force = -trial.spring.stretch(1e-3, laws, trial.motion, trial.normal, trial.normal_force);
    const Vec3 slip = trial.spring.slip();
    const double cone = laws.friction * trial.normal_force;
    const double gained = 0.5 * laws.tangential_stiffness * (slip.squaredNorm() - before.squaredNorm());
    const Vec3 rule = laws.tangential_stiffness * slip + damping * (slip - before) / 1e-3;
    ASSERT_LE(force.norm(), cone * (1.0 + 1e-12)) << i;
    ASSERT_NEAR((force - rule).norm(), 0.0, 1e-9) << i;
    ASSERT_NEAR(force.dot(trial.normal), 0.0, 1e-12) << i;
    ASSERT_GE(force.dot(trial.motion) - gained, -1e-15) << i;
    sliding += force.norm() > cone * (1.0 - 1e-12) ? 1 : 0;
  }
  EXPECT_GT(sliding, 200);
  EXPECT_LT(sliding, 1900);
}

}  // namespace
}  // namespace palpate::contact::test
