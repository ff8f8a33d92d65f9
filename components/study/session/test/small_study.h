#pragma once
#include "study/session/study.h"

namespace palpate::study {

/// A study of one session with few trials: noise threshold, weak force, curve, stiffness and force control.
inline Study small_study() {
  Study study;
  study.name = "small";
  study.scene = "gallbladder";
  study.seed = 7;
  study.max_minutes = 600.0;
  study.break_minutes = 1000.0;
  const Arm off{"off", 0.0, NoiseProfile::kConstant, 5e-3};
  const Arm constant{"constant", 0.6, NoiseProfile::kConstant, 5e-3};
  const Arm paper{"paper", 0.6, NoiseProfile::kProximity, 5e-3};
  study.conditions = {off, constant, paper};

  StudyTask threshold;
  threshold.name = "threshold";
  threshold.kind = TaskKind::kNoiseThreshold;
  threshold.arms = {Arm{}};
  threshold.trials = 40;
  threshold.catch_share = 0.1;
  threshold.sets_threshold = true;
  threshold.repeat_at_end = true;
  threshold.least = 1e-3;
  threshold.largest = 100e-3;
  threshold.steps = 20;

  StudyTask weak = threshold;
  weak.name = "weak-force";
  weak.kind = TaskKind::kForceDetection;
  weak.sets_threshold = false;
  weak.repeat_at_end = false;
  weak.catch_share = 0.0;
  weak.least = 5e-3;
  weak.largest = 500e-3;

  StudyTask curve = weak;
  curve.name = "curve";
  curve.signal = SignalFrom{"weak-force", 0.65};
  curve.trials = 4;
  curve.arms.clear();
  for (const double share : {0.0, 0.3, 0.6}) {
    curve.arms.push_back({"", share, NoiseProfile::kConstant, 5e-3});
  }

  StudyTask stiffness;
  stiffness.name = "stiffness";
  stiffness.kind = TaskKind::kStiffness;
  stiffness.arms = study.conditions;
  stiffness.trials = 10;
  stiffness.practice = 3;
  stiffness.least = 1.02;
  stiffness.largest = 3.3;
  stiffness.steps = 14;
  stiffness.depth = 8e-3;

  StudyTask hold;
  hold.name = "hold";
  hold.kind = TaskKind::kForceControl;
  hold.arms = study.conditions;
  hold.targets = {1.0, 2.0, 4.0};
  hold.repeats = 2;
  hold.trials = 6;

  study.tasks = {threshold, weak, curve, stiffness, hold};
  return study;
}

}  // namespace palpate::study
