#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

// The argument in [low, high] at which a rising function has this value.
double solve(const std::function<double(double)>& function, double value, double low, double high) {
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double sr_correct(double signal, double noise) {
  return probability_second(make_observer("sr"), {signal, noise, true});
}

// Reference noise with 75 % correct against no noise: the interval with noise has more samples above T.
TEST(Observers, StochasticResonanceHasItsReferenceValues) {
  EXPECT_NEAR(solve([](double signal) { return sr_correct(signal, 0.0); }, 0.65, 0.0, 1.0), 0.3783249292,
              1e-9);
  const std::vector<double> shares = {0.0, 0.3, 0.6, 0.9, 1.5, 2.5};
  const std::vector<double> correct = {0.65, 0.69556716, 0.7577147, 0.76822891, 0.72827633, 0.66273063};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(sr_correct(0.3783249292, shares[i] * 0.5817562888), correct[i], 1e-8) << shares[i];
  }
}

TEST(Observers, StochasticResonanceLowersTheForceThreshold) {
  Observer observer = make_observer("sr");
  for (const auto& [internal_noise, ratio] : {std::pair{0.35, 0.76}, std::pair{0.40, 0.84}}) {
    observer.internal_noise = internal_noise;
    const auto threshold = [&](double noise) {
      return solve([&](double a) { return probability_second(observer, {a, noise, true}); }, 0.75, 0.0, 2.0);
    };
    EXPECT_NEAR(threshold(0.6 * 0.5817562888) / threshold(0.0), ratio, 0.015);
  }
}

TEST(Observers, NoiseNeverHelpsTheLinearObserver) {
  const Observer linear = make_observer("linear");
  double last = 1.0;
  for (int i = 0; i < 20; ++i) {
    const double correct = probability_second(linear, {0.3, 0.1 * i, true});
    EXPECT_LT(correct, last);
    last = correct;
  }
  // d' = 0.3/0.35 without noise; Phi(d'/sqrt 2).
  EXPECT_NEAR(probability_second(linear, {0.3, 0.0, true}), 0.5 * std::erfc(-0.3 / 0.35 / 2.0), 1e-14);
}

TEST(Observers, IdealAnswersByTheFunction) {
  const Observer ideal = make_observer("ideal");
  EXPECT_NEAR(probability_second(ideal, {0.0, 0.0, true}), 1.0 - 0.5 / std::exp(1.0), 1e-14);
  EXPECT_NEAR(probability_second(ideal, {0.0, 0.0, false}), 0.5 / std::exp(1.0), 1e-14);
  Observer comparison = ideal;
  comparison.function.shape = PsychometricFunction::Shape::kNormal;
  comparison.parameters = {0.0, 0.2, 0.0};
  EXPECT_NEAR(probability_second(comparison, {0.2}), 0.5 * std::erfc(-1.0 / std::sqrt(2.0)), 1e-14);
}

TEST(Observers, LapsesAreRandomAnswers) {
  const Observer observer = make_observer("lapse");  // 10 %
  EXPECT_NEAR(probability_second(observer, {100.0, 0.0, true}), 0.95, 1e-12);
  EXPECT_NEAR(probability_second(observer, {100.0, 0.0, false}), 0.05, 1e-12);
}

TEST(Observers, RandomAnswersDoNotDependOnTheSignal) {
  for (const bool second : {false, true}) {
    EXPECT_EQ(probability_second(make_observer("random"), {1.0, 0.0, second}), 0.5);
  }
}

// The level with 75 % correct at the end of a session less that at its start, in log10.
double drift_of(const char* name) {
  const Observer observer = make_observer(name);
  const auto threshold = [&](double progress) {
    return solve(
        [&](double x) {
          return probability_second(observer, {x, 0.0, true, progress});
        },
        0.75, -1, 1);
  };
  return threshold(1.0) - threshold(0.0);
}

TEST(Observers, ThresholdsDriftOverASession) {
  EXPECT_NEAR(drift_of("tires"), std::log10(1.3), 1e-9);
  EXPECT_NEAR(drift_of("learns"), -std::log10(1.3), 1e-9);
  EXPECT_NEAR(drift_of("ideal"), 0.0, 1e-9);
}

TEST(Observers, DriftWidensComparisonsAndWeakensSignals) {
  Observer observer = make_observer("tires");
  observer.function.shape = PsychometricFunction::Shape::kNormal;
  observer.parameters = {0.0, 0.2, 0.0};
  EXPECT_NEAR(probability_second(observer, {0.26, 0.0, false, 1.0}), probability_second(observer, {0.2}),
              1e-12);
  Observer sr = make_observer("sr");
  sr.drift = std::log10(1.3);
  EXPECT_NEAR(probability_second(sr, {0.39, 0.0, true, 1.0}), sr_correct(0.3, 0.0), 1e-12);
}

TEST(Observers, AnswersDependOnSeedParticipantAndTrialAlone) {
  int yes = 0;
  int equal = 0;
  constexpr int kTrials = 4000;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    const bool answer = draw_answer(0.3, 5, 1, trial);
    EXPECT_EQ(answer, draw_answer(0.3, 5, 1, trial));
    yes += answer ? 1 : 0;
    equal += answer == draw_answer(0.3, 5, 2, trial) ? 1 : 0;
  }
  EXPECT_NEAR(yes / static_cast<double>(kTrials), 0.3, 0.03);
  EXPECT_NEAR(equal / static_cast<double>(kTrials), 0.58, 0.03);  // 0.3^2 + 0.7^2
}

TEST(Observers, UnknownNamesAreRejected) { EXPECT_THROW((void)make_observer("best"), InputError); }

}  // namespace
}  // namespace palpate::psychophysics
