#pragma once
#include <optional>
#include <string>
#include <vector>

#include <SDL.h>

#include "study/session/run_session.h"
#include "study/session/study.h"

namespace palpate::app {

/// [any] Checks `first`, `second` and `withdraw_key` of a study; needs no display. Names of keys: a to z, 0
/// to 9, F1 to F24, left, right, up, down, tab; of pedals, which send keys: pedal-left (Left, Page Up or F13)
/// and pedal-right (Right, Page Down or F14); of a gamepad: pad: and SDL's button name. @throws InputError
/// for an unknown name, a key with two meanings and F9 to F11
void check_keys(const study::Study& study);

/// [any] Keys for a sentence: "1, F or left pedal".
[[nodiscard]] std::string text_of_keys(const std::vector<std::string>& names,
                                       const study::Language& say = {});

/// What the keys of a study mean. All members: [setup].
class StudyKeys final {
 public:
  /// @throws InputError as check_keys()
  explicit StudyKeys(const study::Study& study);

  /// First, second or next (Space), for a pressed key or gamepad button; empty: another event.
  [[nodiscard]] std::optional<study::ScreenInput> input_of(const SDL_Event& event) const;
  /// Whether the event presses or releases the withdraw key.
  [[nodiscard]] bool withdraws(const SDL_Event& event) const;
  /// Whether an answer key is a gamepad's button.
  [[nodiscard]] bool uses_gamepad() const noexcept;

 private:
  struct Keys {
    std::vector<SDL_Keycode> codes;
    std::vector<SDL_Scancode> positions;  // digits, which some layouts send with Shift only
    std::vector<SDL_GameControllerButton> buttons;

    [[nodiscard]] bool hold(const SDL_Event& event) const;
    [[nodiscard]] bool overlap(const Keys& other) const;
  };

  static std::optional<Keys> keys_of(const std::string& name);
  static Keys read(const study::Study& study, const std::string& field,
                   const std::vector<std::string>& names);

  Keys first_, second_, withdraw_;
};

/// A key that must be held for a while. All members: [any].
class HeldKey final {
 public:
  static constexpr double kHold = 2.0;  // s

  void press(double time) noexcept;
  void release() noexcept { since_.reset(); }
  /// Part of the hold that is over, 0 to 1; 0 while the key is up.
  [[nodiscard]] double part(double time) const noexcept;
  /// Whether the hold has just been completed; true once for each press.
  bool take_completed(double time) noexcept;

 private:
  std::optional<double> since_;  // s
  bool completed_ = false;
};

}  // namespace palpate::app
