#pragma once
// A whole session in the study's windows: a simulated observer holds the device, and keys are pressed as a
// person would press them.
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "palpate/offscreen.h"

#include "study/screens/study_screens.h"

namespace palpate::app {

/// Presses a key from another thread after a time.
class KeyPress final {
 public:
  KeyPress(SDL_Keycode key, std::chrono::milliseconds after)
      : thread_([=] {
          std::this_thread::sleep_for(after);
          SDL_Event event{};
          event.type = SDL_KEYDOWN;
          event.key.keysym.sym = key;
          event.key.keysym.scancode = SDL_GetScancodeFromKey(key);
          SDL_PushEvent(&event);
        }) {}
  ~KeyPress() { thread_.join(); }
  KeyPress(const KeyPress&) = delete;
  KeyPress& operator=(const KeyPress&) = delete;

 private:
  std::thread thread_;
};

/// Shows everything in the real windows, presses the keys, and keeps a picture of each different screen.
class StudyChair final : public study::SessionScreens {
 public:
  /// @param pictures folder that exists; empty: no pictures
  StudyChair(StudyScreens& screens, std::filesystem::path pictures)
      : screens_(screens), pictures_(std::move(pictures)) {}

  void show(const study::ScreenContent& content) override {
    screens_.show(content);
    const bool waits = content.message == "Press Space or an answer key to go on";
    if (waits) key_.emplace(SDLK_SPACE, std::chrono::milliseconds(0));
    const std::string what =
        fmt::format("{}-{}{}{}{}{}{}", content.task, describe(content.trial.state), content.trial.interval,
                    content.trial.deep_enough ? "-up" : "", content.example > 0 ? "-example" : "",
                    content.break_left > 0.0 ? "-break" : "", waits ? "-go-on" : content.message);
    const int seen = ++frames_[what];
    if (seen == 3) save(what);  // not the first one: fonts and layout follow
  }
  std::optional<study::ScreenInput> take_input() override { return screens_.take_input(); }
  std::string take_note() override { return screens_.take_note(); }
  std::optional<std::size_t> ask(const study::Question& question) override {
    const bool second = question.who == "experimenter" && question.answers.back().starts_with("go on with");
    key_.emplace(second ? SDLK_2 : SDLK_1, std::chrono::milliseconds(700));
    const auto answer = screens_.ask(question);
    const std::string start = question.text.substr(0, 24);
    if (++frames_[question.who + start] == 1) save("question-" + question.who);
    ++questions;
    return answer;
  }
  std::optional<bool> audible_trial(const study::AudibleTrial& trial,
                                    const std::function<void(bool)>& noise) override {
    key_.emplace(SDLK_1, std::chrono::milliseconds(3800));
    const auto answer = screens_.audible_trial(trial, noise);
    if (++frames_["audible"] == 1) save("audible");
    return answer;
  }

  int questions = 0;

 private:
  void save(std::string name) {
    if (pictures_.empty()) return;
    for (char& c : name) {
      if (c == ' ') c = '-';
    }
    name = fmt::format("{:02}-{}", ++saved_, name);
    write_png(screens_.participant_picture(), pictures_ / (name + "-participant.png"));
    write_png(screens_.experimenter_picture(), pictures_ / (name + "-experimenter.png"));
  }

  StudyScreens& screens_;
  std::filesystem::path pictures_;
  std::map<std::string, int> frames_;
  int saved_ = 0;
  std::optional<KeyPress> key_;
};

}  // namespace palpate::app
