#include "study/session/simulated_person.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace palpate::study {
namespace {

using psychophysics::Observer;
using psychophysics::ObserverTrial;

constexpr double kSlope = 2.5;  // of detection
constexpr double kNormalAt75 = 0.67448975;

// Parts of a person's random numbers.
constexpr std::uint32_t kPersonPart = 0x7000'0000;
constexpr std::uint64_t kAnswerSeed = 0x616e'7377'6572;  // differs from that of the trials

// Threshold of a constant force with a noise in both intervals, of an observer that counts samples: 75 %
// correct, in units of T.
double force_threshold_of(const Observer& observer, double noise) {
  double low = 0.0;
  double high = 4.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (psychophysics::probability_second(observer, {middle, noise, true}) < 0.75 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// The Weibull function with 75 % correct at `threshold`, on log10 levels.
double detected(double level, double threshold, double drift, double lapse) {
  const double location = threshold + drift - std::log10(std::log(2.0)) / kSlope;
  return psychophysics::PsychometricFunction{}(level, {location, kSlope, lapse});
}

// Factor of ln_spread with a noise [N].
double spread_factor(SimulatedPerson& person, double noise) {
  const Observer& observer = person.observer;
  const double relative = noise / person.force_unit;
  if (observer.kind == Observer::Kind::kLinear) {
    return std::hypot(observer.internal_noise, relative) / observer.internal_noise;
  }
  if (observer.kind != Observer::Kind::kThreshold) return 1.0;
  const auto [entry, is_new] = person.force_thresholds.try_emplace(relative, 0.0);
  if (is_new) entry->second = force_threshold_of(observer, relative) / force_threshold_of(observer, 0.0);
  return entry->second;
}

double detects_force(const SimulatedPerson& person, const Trial& trial, double progress) {
  const Observer& observer = person.observer;
  const double drift = observer.drift * progress;
  if (observer.kind == Observer::Kind::kFunction) {
    return detected(trial.level, std::log10(person.force_unit), drift, person.lapse);
  }
  return psychophysics::probability_second(observer, {std::pow(10.0, trial.level) / person.force_unit,
                                                      trial.noise / person.force_unit, true, progress});
}

double detects_noise(const SimulatedPerson& person, const Trial& trial, double progress) {
  const Observer& observer = person.observer;
  if (observer.kind != Observer::Kind::kThreshold) {
    return detected(trial.level, std::log10(person.noise_threshold), observer.drift * progress, person.lapse);
  }
  ObserverTrial seen{0.0, trial.noise / person.force_unit, true, progress};
  seen.noise_without = 0.0;
  return psychophysics::probability_second(observer, seen);
}

// Cues of a press to the task's depth, give or take 5 %.
IntervalCues press(const StudyTask& task, double ratio, Random& random) {
  IntervalCues cues;
  cues.depth = (task.depth > 0.0 ? task.depth : 8e-3) * std::exp(0.05 * random.normal());
  cues.peak_force = task.standard_k1 * ratio * cues.depth;
  cues.mean_force = 0.5 * cues.peak_force;
  cues.work = 0.5 * cues.peak_force * cues.depth;
  return cues;
}

double called_stiffer(SimulatedPerson& person, const StudyTask& task, const Trial& trial, double progress,
                      Random& random, TrialRecord& record) {
  const std::size_t comparison = trial.second ? 1 : 0;
  record.intervals[comparison] = press(task, std::exp(trial.level), random);
  record.intervals[1 - comparison] = press(task, 1.0, random);
  const double spread = std::exp(person.ln_spread) * spread_factor(person, trial.noise) *
                        std::pow(10.0, person.observer.drift * progress);
  double seen = trial.level - person.interval_bias;
  if (person.kind == "cue-user") {
    seen = std::log(record.intervals[comparison].peak_force / record.intervals[1 - comparison].peak_force);
  }
  const psychophysics::PsychometricFunction normal{psychophysics::PsychometricFunction::Shape::kNormal};
  return normal(seen, {0.0, spread, person.lapse});
}

void hold(const Trial& trial, Random& random, TrialRecord& record) {
  const double common = random.normal();
  record.rms_error = trial.level * 0.08 * std::exp(0.25 * common);
  record.variation = 0.06 * std::exp(0.25 * common + 0.1 * random.normal());
}

}  // namespace

SimulatedPerson make_person(const std::string& kind, std::uint64_t seed, std::uint32_t participant) {
  SimulatedPerson person;
  person.kind = kind;
  person.observer = psychophysics::make_observer(kind == "cue-user" ? "ideal" : kind);
  Random random(seed, participant, kPersonPart);
  person.force_unit = 0.05 * std::pow(10.0, 0.12 * random.normal());
  constexpr double kNoiseShare = 0.5817562888;  // own noise threshold of the observer sr, in units of T
  person.noise_threshold = kNoiseShare * person.force_unit;
  person.inclusion_threshold = std::log10(std::log(2.0)) + 0.1 * random.normal();
  const double difference = 0.08 * std::pow(0.22 / 0.08, random.uniform());
  person.ln_spread = std::log(std::log1p(difference) / kNormalAt75);
  person.interval_bias = 0.03 * random.normal();
  person.lapse = std::max(person.observer.lapse, 0.04 * random.uniform());
  return person;
}

void answer_by_formula(const Study& study, SimulatedPerson& person, const Trial& trial, double progress,
                       std::uint64_t seed, std::uint32_t participant, TrialRecord& record) {
  const StudyTask& task = study.tasks[trial.task];
  Random random(seed ^ kAnswerSeed, participant, trial.draw);
  record.observer = person.kind;
  if (!task.two_intervals()) {
    hold(trial, random, record);
    return;
  }
  double counted = 0.5;
  if (task.stimulus() == Stimulus::kNoise) {
    counted = detects_noise(person, trial, progress);
  } else if (task.stimulus() == Stimulus::kForce) {
    counted = detects_force(person, trial, progress);
  } else if (task.comparison()) {
    counted = called_stiffer(person, task, trial, progress, random, record);
  } else {
    counted =
        detected(trial.level, person.inclusion_threshold + std::log10(spread_factor(person, trial.noise)),
                 person.observer.drift * progress, person.lapse);
  }
  double second = trial.second ? counted : 1.0 - counted;
  if (person.observer.kind == Observer::Kind::kRandom) second = 0.5;
  record.answer = random.uniform() < second ? 2 : 1;
  record.counted = counted_answer(trial, record.answer);
  record.response_time = 0.4 + 0.5 * std::exp(0.3 * random.normal());
}

}  // namespace palpate::study
