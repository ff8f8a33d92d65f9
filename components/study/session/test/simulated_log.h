#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/random.h"

#include "study/session/analysis.h"

namespace palpate::study {

inline constexpr SealedKey kTestKey = 20260301;

/// Three conditions: off, constant and paper.
inline std::vector<Arm> test_conditions() {
  return {{"off", 0.0, NoiseProfile::kConstant, 5e-3},
          {"constant", 0.6, NoiseProfile::kConstant, 5e-3},
          {"paper", 0.6, NoiseProfile::kProximity, 5e-3}};
}

/// A study with tasks "threshold", "curve", "stiffness" and "hold", without a file.
inline Study test_study() {
  Study study;
  study.name = "test";
  study.conditions = test_conditions();
  StudyTask threshold;
  threshold.name = "threshold";
  threshold.arms = {Arm{}};
  threshold.sets_threshold = true;
  threshold.least = 1e-3;
  threshold.largest = 0.1;
  threshold.steps = 20;
  StudyTask curve = threshold;
  curve.name = "curve";
  curve.kind = TaskKind::kForceDetection;
  curve.sets_threshold = false;
  curve.signal = SignalFrom{"weak-force", 0.65};
  curve.arms.clear();
  for (const char* share : {"0", "0.3", "0.6", "0.9", "1.5", "2.5"}) {
    curve.arms.push_back({share, std::stod(share), NoiseProfile::kConstant, 5e-3});
  }
  StudyTask stiffness;
  stiffness.name = "stiffness";
  stiffness.kind = TaskKind::kStiffness;
  stiffness.arms = test_conditions();
  stiffness.least = 1.02;
  stiffness.largest = 3.3;
  stiffness.steps = 14;
  StudyTask hold;
  hold.name = "hold";
  hold.kind = TaskKind::kForceControl;
  hold.arms = test_conditions();
  hold.targets = {1.0, 2.0, 4.0};
  study.tasks = {threshold, curve, stiffness, hold};
  study.primary = PrimaryAnalysis{"stiffness", "constant", "off", "ln_jnd", "less"};
  study.inverted_u = InvertedUAnalysis{"curve", {0.0}, {0.6, 0.9}, {2.5}, 0.05};
  return study;
}

/// The code of an arm of a participant.
inline std::string code_of(std::uint32_t participant, std::size_t task, std::size_t arm, std::size_t arms) {
  const std::vector<std::size_t> of_codes = arms_of_codes(kTestKey, participant, task, arms);
  for (std::size_t i = 0; i < arms; ++i) {
    if (of_codes[i] == arm) return "c" + std::to_string(i + 1);
  }
  return "";
}

/// Probability of the counted answer in an arm, at a level, in trial number i of n.
using Probability = std::function<double(std::size_t arm, double level, double progress)>;

/// Appends `trials` trials of a task for each arm, interleaved; levels are repeated in turn.
inline void add_trials(Participant& person, const Study& study, std::size_t task, int trials,
                       const std::vector<double>& levels, const Probability& probability, Random& random) {
  const StudyTask& of = study.tasks[task];
  const int arms = static_cast<int>(of.arms.size());
  for (int i = 0; i < trials * arms; ++i) {
    const auto arm = static_cast<std::size_t>(i % arms);
    TrialRecord trial;
    trial.time = "2026-03-01T09:00:00.000Z";
    trial.task = of.name;
    trial.number = i;
    trial.code = code_of(person.number, task, arm, of.arms.size());
    trial.level = levels[static_cast<std::size_t>(i / arms) % levels.size()];
    trial.second = random.uniform() < 0.5;
    trial.counted =
        random.uniform() < probability(arm, trial.level, static_cast<double>(i) / (trials * arms));
    trial.answer = trial.counted == trial.second ? 2 : 1;
    trial.response_time = 0.7;
    person.log.trials.push_back(trial);
  }
}

/// Stimuli about a threshold, or about 0 for a comparison: near in steps of the grid.
inline std::vector<double> levels_near(const StudyTask& task, double centre, double half) {
  std::vector<double> near;
  for (const double level : grid_of(task).levels) {
    if (std::abs(level - centre) <= half) near.push_back(level);
  }
  return near;
}

inline Participant new_participant(std::uint32_t number) {
  Participant person;
  person.number = number;
  person.log.id = "P" + std::to_string(1000 + number);
  return person;
}

/// Adds answers of a person who detects a stimulus by the task's function. @param threshold, slope of it
inline void add_detection(Participant& person, const Study& study, std::size_t task, int trials,
                          const std::vector<double>& levels, double threshold, double slope, Random& random) {
  const auto function = grid_of(study.tasks[task]).function;
  add_trials(
      person, study, task, trials, levels,
      [&](std::size_t, double level, double) {
        return function(level, {threshold, slope, 0.0});
      },
      random);
}

/// Adds a comparison of stiffness. @param spreads s in each arm
inline void add_stiffness(Participant& person, const Study& study, int trials,
                          const std::vector<double>& spreads, Random& random, double lapse = 0.0) {
  const StudyTask& task = study.tasks[2];
  const auto function = grid_of(task).function;
  add_trials(
      person, study, 2, trials, levels_near(task, 0.0, 0.5),
      [&](std::size_t arm, double level, double) {
        return function(level, {0.0, spreads[arm], lapse});
      },
      random);
}

}  // namespace palpate::study
