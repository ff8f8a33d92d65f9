#include "study/screens/study_keys.h"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::app {
namespace {

using study::ScreenInput;
using study::Study;

constexpr const char* kPad = "pad:";
constexpr std::size_t kPadLength = 4;

/// Key code of "f1" to "f24".
std::optional<SDL_Keycode> function_key(const std::string& name) {
  if (name.size() < 2 || name.size() > 3 || name[0] != 'f' || name[1] == '0') return std::nullopt;
  int number = 0;
  for (const char digit : name.substr(1)) {
    if (digit < '0' || digit > '9') return std::nullopt;
    number = 10 * number + (digit - '0');
  }
  if (number > 24) return std::nullopt;
  return number <= 12 ? SDLK_F1 + number - 1 : SDLK_F13 + number - 13;
}

std::string valid_names() {
  std::string buttons;
  for (int button = 0; button < SDL_CONTROLLER_BUTTON_MAX; ++button) {
    const char* name = SDL_GameControllerGetStringForButton(static_cast<SDL_GameControllerButton>(button));
    if (name != nullptr) buttons += std::string(buttons.empty() ? "" : ", ") + kPad + name;
  }
  return "a to z, 0 to 9, F1 to F24 except F9 to F11, left, right, up, down, tab, pedal-left, pedal-right, " +
         buttons;
}

[[noreturn]] void fail(const Study& study, const std::string& field, const std::string& name,
                       const std::string& want) {
  throw InputError(fmt::format("{}: {} = \"{}\": {}", study.file.string(), field, name, want));
}

}  // namespace

std::optional<StudyKeys::Keys> StudyKeys::keys_of(const std::string& name) {
  const std::string key = lower_case(name);
  if (key.starts_with(kPad)) {
    const auto button = SDL_GameControllerGetButtonFromString(key.c_str() + kPadLength);
    if (button == SDL_CONTROLLER_BUTTON_INVALID) return std::nullopt;
    return Keys{{}, {}, {button}};
  }
  if (key == "pedal-left") return Keys{{SDLK_LEFT, SDLK_PAGEUP, SDLK_F13}, {}, {}};
  if (key == "pedal-right") return Keys{{SDLK_RIGHT, SDLK_PAGEDOWN, SDLK_F14}, {}, {}};
  if (key == "left") return Keys{{SDLK_LEFT}, {}, {}};
  if (key == "right") return Keys{{SDLK_RIGHT}, {}, {}};
  if (key == "up") return Keys{{SDLK_UP}, {}, {}};
  if (key == "down") return Keys{{SDLK_DOWN}, {}, {}};
  if (key == "tab") return Keys{{SDLK_TAB}, {}, {}};
  if (const std::optional<SDL_Keycode> code = function_key(key)) return Keys{{*code}, {}, {}};
  if (key.size() != 1) return std::nullopt;
  if (key[0] >= 'a' && key[0] <= 'z') return Keys{{key[0]}, {}, {}};
  if (key[0] < '0' || key[0] > '9') return std::nullopt;
  const int after_one = (key[0] - '0' + 9) % 10;  // SDL counts 1, 2, ..., 9, 0
  const auto pad = static_cast<SDL_Scancode>(SDL_SCANCODE_KP_1 + after_one);
  return Keys{
      {key[0], SDL_SCANCODE_TO_KEYCODE(pad)}, {static_cast<SDL_Scancode>(SDL_SCANCODE_1 + after_one)}, {}};
}

StudyKeys::Keys StudyKeys::read(const Study& study, const std::string& field,
                                const std::vector<std::string>& names) {
  const Keys reserved{{SDLK_F9, SDLK_F10, SDLK_F11}, {}, {}};
  Keys all;
  for (const std::string& name : names) {
    const std::optional<Keys> keys = keys_of(name);
    if (!keys) fail(study, field, name, "no such key; keys are " + valid_names());
    if (keys->overlap(reserved)) {
      fail(study, field, name,
           "F9 (pause), F10 (force off) and F11 (full screen) are taken; use another key");
    }
    all.codes.insert(all.codes.end(), keys->codes.begin(), keys->codes.end());
    all.positions.insert(all.positions.end(), keys->positions.begin(), keys->positions.end());
    all.buttons.insert(all.buttons.end(), keys->buttons.begin(), keys->buttons.end());
  }
  return all;
}

StudyKeys::StudyKeys(const Study& study)
    : first_(read(study, "response.first", study.first_keys)),
      second_(read(study, "response.second", study.second_keys)),
      withdraw_(read(study, "ethics.withdraw_key", {study.withdraw_key})) {
  if (!withdraw_.buttons.empty()) {
    fail(study, "ethics.withdraw_key", study.withdraw_key, "must be a key of the keyboard");
  }
  for (const std::string& name : study.second_keys) {
    if (keys_of(name)->overlap(first_)) {
      fail(study, "response.second", name, "is also a key of `first`; each key must have one meaning");
    }
  }
  if (withdraw_.overlap(first_) || withdraw_.overlap(second_)) {
    fail(study, "ethics.withdraw_key", study.withdraw_key,
         "is also an answer; each key must have one meaning");
  }
}

bool StudyKeys::Keys::hold(const SDL_Event& event) const {
  if (event.type == SDL_CONTROLLERBUTTONDOWN) {
    return std::find(buttons.begin(), buttons.end(), event.cbutton.button) != buttons.end();
  }
  if (event.type != SDL_KEYDOWN && event.type != SDL_KEYUP) return false;
  const SDL_Keysym& key = event.key.keysym;
  return std::find(codes.begin(), codes.end(), key.sym) != codes.end() ||
         std::find(positions.begin(), positions.end(), key.scancode) != positions.end();
}

bool StudyKeys::Keys::overlap(const Keys& other) const {
  return std::find_first_of(codes.begin(), codes.end(), other.codes.begin(), other.codes.end()) !=
             codes.end() ||
         std::find_first_of(buttons.begin(), buttons.end(), other.buttons.begin(), other.buttons.end()) !=
             buttons.end();
}

std::optional<ScreenInput> StudyKeys::input_of(const SDL_Event& event) const {
  if (event.type == SDL_KEYUP || (event.type == SDL_KEYDOWN && event.key.repeat != 0)) return std::nullopt;
  if (first_.hold(event)) return ScreenInput::kFirst;
  if (second_.hold(event)) return ScreenInput::kSecond;
  if (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_SPACE) return ScreenInput::kNext;
  return std::nullopt;
}

bool StudyKeys::withdraws(const SDL_Event& event) const { return withdraw_.hold(event); }

bool StudyKeys::uses_gamepad() const noexcept { return !first_.buttons.empty() || !second_.buttons.empty(); }

void check_keys(const Study& study) { (void)StudyKeys(study); }

std::string text_of_keys(const std::vector<std::string>& names, const study::Language& say) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? say(" or ") : ", ";
    std::string name = lower_case(names[i]);
    if (name.starts_with(kPad)) {
      std::string button = name.substr(kPadLength);
      if (button.size() == 1)
        button[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(button[0])));
      name = fmt::format(fmt::runtime(say("gamepad {}")), button);
    } else if (name.starts_with("pedal-")) {
      name = say(name.substr(6) + " pedal");
    } else if (name.size() <= 3) {
      name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    }
    text += name;
  }
  return text;
}

void HeldKey::press(double time) noexcept {
  if (since_) return;  // the keyboard repeats
  since_ = time;
  completed_ = false;
}

double HeldKey::part(double time) const noexcept {
  return since_ ? std::clamp((time - *since_) / kHold, 0.0, 1.0) : 0.0;
}

bool HeldKey::take_completed(double time) noexcept {
  if (completed_ || part(time) < 1.0) return false;
  completed_ = true;
  return true;
}

}  // namespace palpate::app
