#include <cmath>
#include <string>

#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "palpate/error.h"

#include "study/psychophysics/normal.h"
#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {
namespace {

constexpr double kLn10 = 2.30258509299404568402;
constexpr double kLog10Of1point3 = 0.11394335230683677;  // 30 % over a session

// Signal as a multiple of the threshold, which drifts.
double signal_of(const Observer& observer, const ObserverTrial& trial) noexcept {
  return trial.level * portable::exp(-kLn10 * observer.drift * trial.progress);
}

double noise_of(const Observer& observer, double noise) noexcept {
  return std::sqrt(observer.internal_noise * observer.internal_noise + noise * noise);
}

double by_function(const Observer& observer, const ObserverTrial& trial) noexcept {
  Parameters at = observer.parameters;
  const double drift = observer.drift * trial.progress;
  if (observer.function.shape == PsychometricFunction::Shape::kWeibull) {
    at.location += drift / observer.function.decades_per_unit;
  } else {
    at.spread *= portable::exp(kLn10 * drift);
  }
  return observer.function(trial.level, at);
}

double power(double base, int exponent) noexcept {
  double product = 1.0;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

// Probability that n of m samples exceed the threshold.
double binomial(int m, int n, double probability) noexcept {
  double coefficient = 1.0;
  for (int i = 1; i <= n; ++i) coefficient = coefficient * (m - n + i) / i;
  return coefficient * power(probability, n) * power(1.0 - probability, m - n);
}

// Probability that more samples exceed the threshold with the signal than without; ties count half.
double threshold_correct(const Observer& observer, const ObserverTrial& trial) noexcept {
  const double with = normal_cdf((signal_of(observer, trial) - 1.0) / noise_of(observer, trial.noise));
  const double without = normal_cdf(-1.0 / noise_of(observer, trial.noise_without.value_or(trial.noise)));
  double sum = 0.0;
  double fewer = 0.0;  // probability of fewer samples without the signal
  for (int n = 0; n <= observer.samples; ++n) {
    const double equal = binomial(observer.samples, n, without);
    sum += binomial(observer.samples, n, with) * (fewer + 0.5 * equal);
    fewer += equal;
  }
  return sum;
}

double with_lapses(const Observer& observer, double probability) noexcept {
  return 0.5 * observer.lapse + (1.0 - observer.lapse) * probability;
}

}  // namespace

Observer make_observer(std::string_view name) {
  Observer observer;
  using Kind = Observer::Kind;
  if (name == "ideal") return observer;
  if (name == "linear") {
    observer.kind = Kind::kLinear;
  } else if (name == "sr") {
    observer.kind = Kind::kThreshold;
  } else if (name == "lapse") {
    observer.lapse = 0.1;
  } else if (name == "random") {
    observer.kind = Kind::kRandom;
  } else if (name == "tires") {
    observer.drift = kLog10Of1point3;
  } else if (name == "learns") {
    observer.drift = -kLog10Of1point3;
  } else {
    throw InputError("observer: `" + std::string(name) +
                     "` is not ideal, linear, sr, lapse, random, tires, learns or, in studies, cue-user");
  }
  return observer;
}

double probability_second(const Observer& observer, const ObserverTrial& trial) noexcept {
  double correct = 0.5;
  switch (observer.kind) {
    case Observer::Kind::kFunction:
      correct = by_function(observer, trial);
      if (observer.function.shape == PsychometricFunction::Shape::kNormal) {
        return with_lapses(observer, correct);
      }
      break;
    case Observer::Kind::kLinear:  // [Green and Swets 1966]: P = Phi(d'/sqrt 2)
      correct = normal_cdf(signal_of(observer, trial) / noise_of(observer, trial.noise) / std::sqrt(2.0));
      break;
    case Observer::Kind::kThreshold:
      correct = threshold_correct(observer, trial);
      break;
    case Observer::Kind::kRandom:
      break;
  }
  return with_lapses(observer, trial.second ? correct : 1.0 - correct);
}

bool draw_answer(double probability, std::uint64_t seed, std::uint32_t participant,
                 std::uint32_t trial) noexcept {
  return Random(seed, participant, trial).uniform() < probability;
}

}  // namespace palpate::psychophysics
