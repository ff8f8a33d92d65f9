#include "core/model/relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

const std::vector<RelaxationTerm> kTwoTerms = {{0.3, 0.2}, {0.25, 5.0}};

TEST(Relaxation, NoTermsGiveTheElasticForce) {
  const Relaxation none;
  RelaxationState state;
  for (const double force : {0.0, 1.0, 0.3, 7.0}) EXPECT_EQ(none.next(state, force), force);
}

// A step of 2 N relaxes as 2 (1 - 0.3 (1 - e^(-t/0.2)) - 0.25 (1 - e^(-t/5))). The update treats a step as a
// ramp over one sample, so the first sample is very short.
TEST(Relaxation, AStepFallsAsThePronySeries) {
  Relaxation relaxation(kTwoTerms, 1e-12);
  RelaxationState state;
  EXPECT_NEAR(relaxation.next(state, 2.0), 2.0, 1e-10);
  relaxation.set_step(1e-3);
  for (int n = 1; n <= 10'000; ++n) {
    const double t = n * 1e-3;
    const double want = 2.0 * (1.0 - 0.3 * (1.0 - std::exp(-t / 0.2)) - 0.25 * (1.0 - std::exp(-t / 5.0)));
    ASSERT_NEAR(relaxation.next(state, 2.0), want, 1e-10) << t;
  }
}

// A ramp of r N/s: F = r ((1 - sum g_i) t + sum g_i tau_i (1 - e^(-t/tau_i))), exact at the samples for any
// spacing.
TEST(Relaxation, ARampIsExactAtAnyStep) {
  for (const double step : {1e-4, 0.05, 0.7}) {
    const Relaxation relaxation(kTwoTerms, step);
    RelaxationState state;
    for (int n = 1; n <= 200; ++n) {
      const double t = n * step;
      const double want =
          3.0 * (0.45 * t + 0.3 * 0.2 * (1.0 - std::exp(-t / 0.2)) + 0.25 * 5.0 * (1.0 - std::exp(-t / 5.0)));
      ASSERT_NEAR(relaxation.next(state, 3.0 * t), want, 1e-10 * want) << step << ' ' << t;
    }
  }
}

TEST(Relaxation, StepsOfOtherLengthsGiveTheSame) {
  const Relaxation relaxation(kTwoTerms, 0.1);
  Relaxation other = relaxation;
  RelaxationState even;
  RelaxationState odd;
  for (int n = 1; n <= 50; ++n) {
    const double want = relaxation.next(even, 0.2 * n);
    other.set_step(0.03);
    (void)other.next(odd, 0.2 * n - 0.14);  // on the same ramp
    other.set_step(0.07);
    ASSERT_NEAR(other.next(odd, 0.2 * n), want, 1e-12 * want);
  }
}

TEST(Relaxation, HeldForeverKeepsTheLastingShare) {
  const Relaxation relaxation(kTwoTerms, 1e-2);
  RelaxationState state;
  double force = 0.0;
  for (int n = 0; n < 20'000; ++n) force = relaxation.next(state, 1.0);
  EXPECT_NEAR(force, 0.45, 1e-12);
}

// On any path out and back, a hand gets back no more energy than it put in. Both laws, at any depth and
// speed, with the force of a contact that cannot pull (never below 0).
template <typename Law>
void expect_no_energy_back(const Law& law) {
  constexpr double kStep = 1e-3;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int trial = 0; trial < 40; ++trial) {
    const double total = 0.95 * share(random);
    const std::vector<RelaxationTerm> terms = {{0.5 * total, 1e-2 + share(random)}, {0.5 * total, 5e-2}};
    const Relaxation relaxation(terms, kStep);
    RelaxationState state;
    double depth = 0.0;
    double force = 0.0;
    double work = 0.0;
    double most = 0.0;
    double target = 0.0;
    for (int n = 0; n < 20'000; ++n) {
      if (n % 97 == 0) target = 0.9 * law.max_depth() * share(random);
      if (n > 19'500) target = 0.0;  // returns at the end
      const double next = depth + std::clamp(target - depth, -2e-4, 2e-4);
      const double after = std::max(0.0, relaxation.next(state, law.force_at(next).force));
      work += 0.5 * (force + after) * (next - depth);
      most = std::max(most, work);
      ASSERT_GE(work, -1e-3 * most - 1e-12) << trial << ' ' << n;
      depth = next;
      force = after;
    }
    EXPECT_GT(work, 0.0);
  }
}

TEST(Relaxation, NeverGivesBackMoreEnergyThanWasPutIn) {
  const TissueParameters tissue = tissue_preset("gallbladder");
  expect_no_energy_back(LayeredSpringLaw(tissue, Direction::kPress, 1e-3));
  expect_no_energy_back(SmoothSpringLaw(tissue, Direction::kPress, 1e-3));
}

TEST(Relaxation, RefusesTermsThatAreNone) {
  using Terms = std::vector<RelaxationTerm>;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Relaxation(Terms{{0.0, 1.0}}, 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(Terms{{kNaN, 1.0}}, 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(Terms{{0.3, 0.0}}, 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(Terms{{0.3, -1.0}}, 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(Terms({{0.5, 1.0}, {0.5, 2.0}}), 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(Terms({{0.1, 1.0}, {0.1, 2.0}, {0.1, 3.0}, {0.1, 4.0}}), 1e-3), ParameterError);
  EXPECT_THROW(Relaxation(kTwoTerms, 0.0), ParameterError);
  EXPECT_THROW(Relaxation(kTwoTerms, kNaN), ParameterError);
}

}  // namespace
}  // namespace palpate::model
