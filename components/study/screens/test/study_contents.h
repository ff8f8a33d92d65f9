#pragma once
// Contents of a study's windows, for tests and pictures.
#include <string>

#include "study/session/run_session.h"
#include "study/session/study.h"

namespace palpate::app::contents {

/// A study with a noise threshold task, a stiffness task and a task without intervals.
inline study::Study study() {
  study::Study study;
  study.file = "touch-noise.toml";
  study.name = "touch-noise-1";
  study.withdraw_key = "F12";
  study.first_keys = {"1", "f", "pedal-left"};
  study.second_keys = {"2", "j", "pedal-right"};
  study.sound_mask = "none";
  for (const auto& [name, kind] : {std::pair("threshold", study::TaskKind::kNoiseThreshold),
                                   std::pair("stiffness", study::TaskKind::kStiffness),
                                   std::pair("hold", study::TaskKind::kForceControl)}) {
    study::StudyTask task;
    task.name = name;
    task.kind = kind;
    study.tasks.push_back(task);
  }
  return study;
}

/// A moment of a trial of a task.
inline study::ScreenContent moment(study::TrialState state, const std::string& task = "threshold") {
  study::ScreenContent content;
  content.task = task;
  content.sentence = task == "stiffness" ? "Press twice, each time to the mark. Which one was stiffer?"
                                         : "Press gently and hold. In which interval did it tingle?";
  content.trial.state = state;
  content.trial.interval = state == study::TrialState::kInterval ? 1 : 0;
  content.trial.force = 0.84;
  content.trial.low = 0.5;
  content.trial.high = 1.5;
  content.session = 2;
  content.block = 3;
  content.position = {1, 5, 13, 60};
  content.spoiled = 2;
  content.catch_trials = 6;
  content.catch_correct = 5;
  content.minutes = 12.57;
  content.max_force = 6.0;
  content.ladder = {20e-3, 14e-3,  10e-3,  7.1e-3, 5e-3,   7.9e-3, 5.6e-3,
                    4e-3,  6.3e-3, 8.9e-3, 7.1e-3, 6.3e-3, 100e-3, 5.6e-3};
  return content;
}

inline study::Question blinding(const std::string& who) {
  return {who, "Was there noise in the last trial?", {"Yes", "No", "I am not sure"}};
}

inline study::Question ages() {
  return {
      "participant",
      "How old are you?",
      {"18 to 24", "25 to 34", "35 to 44", "45 to 54", "55 to 64", "65 to 74", "75 or more", "no answer"}};
}

/// A consent form that is longer than a page.
inline study::Question consent() {
  std::string text = "# Consent\n\n";
  for (int i = 0; i < 5; ++i) {
    text +=
        "You hold the handle of a haptic device and press on simulated tissue. The device pushes back\n"
        "with a force of at most 6 N, and its handle may vibrate slightly.\n\n"
        "- You can stop at any time, without a reason: hold F12 for two seconds, or let go.\n"
        "- The simulator is no medical device and gives no diagnosis.\n"
        "1. Your answers are stored under a random code, without your name.\n\n";
  }
  return {"participant", text, {"Yes, I take part", "No"}};
}

}  // namespace palpate::app::contents
