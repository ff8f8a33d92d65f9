// Draws the study's windows on a virtual display: palpate_study_pictures FOLDER [WIDTH HEIGHT [LANGUAGE]].
// With a size all states are drawn, else the pictures of docs/pictures.
#include <filesystem>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "palpate/offscreen.h"

#include "app/window/test/virtual_display.h"
#include "study/screens/study_screens.h"
#include "study/screens/test/study_contents.h"

namespace {

using palpate::app::StudyScreens;
using palpate::app::StudyScreensOptions;
using palpate::study::ScreenContent;
using palpate::study::TrialState;
namespace contents = palpate::app::contents;

class Pictures {
 public:
  Pictures(std::filesystem::path folder, palpate::app::Display::Size size, const std::string& language = "en")
      : study_(contents::study()), folder_(std::move(folder)) {
    study_.language = palpate::study::builtin_language(language);
    StudyScreensOptions options;
    options.title = "touch-noise-1: PK7Q2";
    options.size = size;
    options.sound = false;
    screens_ = std::make_unique<StudyScreens>(study_, options);
  }

  void show(const ScreenContent& content) {
    for (int i = 0; i < 4; ++i) screens_->show(content);
  }
  void save(const std::string& participant, const std::string& experimenter = {}) {
    if (!participant.empty()) write_png(screens_->participant_picture(), folder_ / (participant + ".png"));
    if (!experimenter.empty()) write_png(screens_->experimenter_picture(), folder_ / (experimenter + ".png"));
  }
  /// Draws a question, which `key` then answers.
  void ask(const palpate::study::Question& question, const std::string& participant,
           const std::string& experimenter = {}) {
    later(1500, SDLK_1);
    (void)screens_->ask(question);
    save(participant, experimenter);
  }
  void audible() {
    later(1500, SDLK_ESCAPE);
    later(1700, SDLK_RETURN);
    (void)screens_->audible_trial({3, 20, false}, [](bool) {});
    save("audible-stop");
    screens_->take_input();
    later(4500, SDLK_1);
    (void)screens_->audible_trial({3, 20, false}, [](bool) {});
    save("audible-answer");
  }
  void withdraw(const ScreenContent& content) {
    push(SDLK_F12, SDL_KEYDOWN);
    show(content);
    SDL_Delay(800);
    show(content);
    save("withdraw", "experimenter-withdraw");
    push(SDLK_F12, SDL_KEYUP);
    show(content);
  }

 private:
  static void push(SDL_Keycode key, Uint32 type) {
    SDL_Event event{};
    event.type = type;
    event.key.keysym.sym = key;
    event.key.keysym.scancode = SDL_GetScancodeFromKey(key);
    SDL_PushEvent(&event);
  }
  static void later(int milliseconds, SDL_Keycode key) {
    std::thread([=] {
      SDL_Delay(static_cast<Uint32>(milliseconds));
      push(key, SDL_KEYDOWN);
    }).detach();
  }

  palpate::study::Study study_;
  std::filesystem::path folder_;
  std::unique_ptr<StudyScreens> screens_;
};

void draw_all(Pictures& pictures) {
  pictures.show(contents::moment(TrialState::kHome));
  pictures.save("home", "experimenter-home");
  ScreenContent press = contents::moment(TrialState::kReach);
  press.trial.bar = true;
  press.trial.force = 0.38;
  pictures.show(press);
  pictures.save("press-more");
  press.trial.force = 0.9;
  pictures.show(press);
  pictures.save("press-good");
  press.trial.force = 2.1;
  pictures.show(press);
  pictures.save("press-less");
  pictures.show(contents::moment(TrialState::kInterval));
  pictures.save("interval", "experimenter-threshold");
  pictures.show(contents::moment(TrialState::kGap));
  pictures.save("gap");
  pictures.show(contents::moment(TrialState::kAnswer));
  pictures.save("answer", "experimenter-answer");
  ScreenContent correct = contents::moment(TrialState::kFinished);
  correct.message = "correct";
  pictures.show(correct);
  pictures.save("correct");
  ScreenContent rest = contents::moment(TrialState::kIdle);
  rest.break_left = 24.3;
  rest.message = "Take a break";
  pictures.show(rest);
  pictures.save("break", "experimenter-break");
  ScreenContent fault = contents::moment(TrialState::kReach);
  fault.trial.fault = 2;
  pictures.show(fault);
  pictures.save("fault", "experimenter-fault");
  ScreenContent come_up = contents::moment(TrialState::kInterval, "stiffness");
  come_up.trial.deep_enough = true;
  come_up.trial.interval = 2;
  pictures.show(come_up);
  pictures.save("come-up", "experimenter-stiffness");
  ScreenContent idle = contents::moment(TrialState::kIdle);
  idle.message = "Press Space or an answer key to go on";
  pictures.show(idle);
  pictures.save("idle");
  pictures.withdraw(contents::moment(TrialState::kInterval));
  pictures.ask(contents::consent(), "question-consent", "experimenter-consent");
  pictures.ask({"participant", describe(palpate::study::TaskKind::kStiffness).instructions, {"Go on"}},
               "question-instructions");
  pictures.ask(contents::blinding("participant"), "question-blinding");
  pictures.ask(contents::ages(), "question-ages");
  pictures.ask(contents::blinding("experimenter"), "question-waits", "experimenter-blinding");
  pictures.audible();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2 && argc != 4 && argc != 5)
      throw std::runtime_error("usage: palpate_study_pictures FOLDER [WIDTH HEIGHT [LANGUAGE]]");
    const palpate::app::VirtualDisplay display;
    if (!display.there()) throw std::runtime_error("there is no Xvfb (Debian package xvfb)");
    if (argc >= 4) {
      Pictures pictures(argv[1], {std::stoi(argv[2]), std::stoi(argv[3])}, argc == 5 ? argv[4] : "en");
      draw_all(pictures);
      return 0;
    }
    Pictures pictures(argv[1], {1280, 720});
    pictures.show(contents::moment(TrialState::kInterval));
    pictures.save("study-participant", "study-experimenter");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "palpate_study_pictures: " << error.what() << '\n';
    return 2;
  }
}
