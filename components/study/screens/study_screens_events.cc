// Keys, gamepads and mouse of a study's windows.

#include <imgui.h>

#include "io/system/clock.h"

#include "study/screens/study_screens.h"

namespace palpate::app {
namespace {

using study::ScreenInput;

constexpr double kDeafTime =
    0.5;  // s after a question appears; earlier keys were meant for the screen before

/// The window that an event belongs to; 0: none.
std::uint32_t window_of(const SDL_Event& event) {
  switch (event.type) {
    case SDL_WINDOWEVENT:
      return event.window.windowID;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
      return event.key.windowID;
    case SDL_TEXTINPUT:
      return event.text.windowID;
    case SDL_MOUSEMOTION:
      return event.motion.windowID;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
      return event.button.windowID;
    case SDL_MOUSEWHEEL:
      return event.wheel.windowID;
    default:
      return 0;
  }
}

/// Number of a digit key, 1 to 9; 0: another key.
int digit_of(const SDL_Keysym& key) {
  if (key.scancode >= SDL_SCANCODE_1 && key.scancode <= SDL_SCANCODE_9)
    return key.scancode - SDL_SCANCODE_1 + 1;
  if (key.scancode >= SDL_SCANCODE_KP_1 && key.scancode <= SDL_SCANCODE_KP_9)
    return key.scancode - SDL_SCANCODE_KP_1 + 1;
  return key.sym >= SDLK_1 && key.sym <= SDLK_9 ? key.sym - SDLK_1 + 1 : 0;
}

double event_time() { return 1e-9 * static_cast<double>(monotonic_ns()); }

}  // namespace

void StudyScreens::take_event(const SDL_Event& event) {
  const std::uint32_t id = window_of(event);
  Viewport& window = experimenter_ != nullptr && id == experimenter_window() ? *experimenter_ : *participant_;
  window.activate();
  window.take(event);
  if (event.type == SDL_QUIT ||
      (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_CLOSE)) {
    leave();
  } else if (event.type == SDL_KEYDOWN) {
    key_down(event, window);
  } else if (event.type == SDL_KEYUP) {
    if (keys_.withdraws(event)) withdraw_.release();
  } else if (event.type == SDL_CONTROLLERBUTTONDOWN) {
    const std::optional<ScreenInput> input = keys_.input_of(event);
    if (input && !question_) press(*input);
  } else if (event.type == SDL_CONTROLLERDEVICEADDED && keys_.uses_gamepad()) {
    SDL_GameController* pad = SDL_GameControllerOpen(event.cdevice.which);
    if (pad != nullptr) gamepads_.push_back(pad);
  }
}

void StudyScreens::function_key(SDL_Keycode key, Viewport& window) {
  if (key == SDLK_F9) press(ScreenInput::kPause);
  if (key == SDLK_F10) press(ScreenInput::kForceOff);
  if (key == SDLK_F11) window.display().toggle_full_screen();
}

void StudyScreens::key_down(const SDL_Event& event, Viewport& window) {
  const SDL_Keycode key = event.key.keysym.sym;
  if (keys_.withdraws(event)) withdraw_.press(event_time());
  if (event.key.repeat != 0) return;
  function_key(key, window);
  if (controls_.typing && &window == experimenter_.get()) return;
  if (key == SDLK_ESCAPE) {
    asks_to_stop_ = !asks_to_stop_;
    return;
  }
  if (asks_to_stop_ && (key == SDLK_RETURN || key == SDLK_KP_ENTER)) {
    asks_to_stop_ = false;
    press(ScreenInput::kStop);
    return;
  }
  if (question_) {
    const int digit = digit_of(event.key.keysym);
    const bool heard = event_time() > question_since_ + kDeafTime;
    if (heard && question_->answers.size() == 1 && keys_.input_of(event) == ScreenInput::kNext) answer_ = 0;
    if (heard && digit >= 1 && static_cast<std::size_t>(digit) <= question_->answers.size())
      answer_ = static_cast<std::size_t>(digit - 1);
    return;
  }
  if (const std::optional<ScreenInput> input = keys_.input_of(event)) press(*input);
}

}  // namespace palpate::app
