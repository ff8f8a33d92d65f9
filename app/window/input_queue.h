#pragma once
#include <array>
#include <bitset>
#include <cstdint>
#include <deque>
#include <string>

#include <SDL.h>

namespace palpate::app {

/// Passes keys, mouse buttons and text to Dear ImGui 1.86, which reads their state once a frame and has no
/// queue of its own. Two changes of the same key or button are in different frames, so that a tap or a double
/// click within one slow frame is not lost. The order of all events is kept. All members: [any], one thread.
class InputQueue final {
 public:
  static constexpr std::size_t kButtons = 3;

  /// What a frame reads.
  struct Frame {
    std::bitset<SDL_NUM_SCANCODES> keys;   // held, by scancode
    std::array<bool, kButtons> buttons{};  // held
    std::uint16_t modifiers = 0;           // bits of KMOD_CTRL, KMOD_SHIFT, KMOD_ALT and KMOD_GUI
    std::string text;                      // typed since the last frame, UTF-8
  };

  /// Adds a press or release of a key. Repeats of a held key are ignored.
  void add_key(const SDL_KeyboardEvent& key);
  /// Adds a press or release of a button. @param button below kButtons
  void add_button(std::size_t button, bool down);
  void add_text(const char* text);
  /// The state for the next frame, after as many of the events as it can show.
  [[nodiscard]] Frame next();

 private:
  struct Event {
    enum class Kind { kKey, kButton, kText };
    Kind kind = Kind::kText;
    std::size_t which = 0;  // scancode or button
    bool down = false;
    bool command = false;  // a key that edits or leaves a field, so that later text waits for the next frame
    std::uint16_t modifiers = 0;
    std::string text;
  };

  std::deque<Event> waiting_;
  Frame now_;
};

/// Whether Esc leaves the program. An Esc that closes something is often pressed twice, so the next half
/// second of Esc leaves nothing. All members: [any], one thread.
class EscapeGuard final {
 public:
  static constexpr std::uint32_t kQuiet = 500;  // ms

  /// @param time of the key [ms] @param closes whether this Esc closes a dialog or list, or leaves a panel
  /// @return whether it leaves the program
  [[nodiscard]] bool leaves(std::uint32_t time, bool closes) noexcept;

 private:
  bool used_ = false;
  std::uint32_t used_at_ = 0;  // ms, of the last Esc that closed something
};

}  // namespace palpate::app
