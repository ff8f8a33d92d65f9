#include "app/window/input_queue.h"

#include <utility>

namespace palpate::app {
namespace {

constexpr int kSpace = SDLK_SPACE;
constexpr unsigned kModifiers = KMOD_CTRL | KMOD_SHIFT | KMOD_ALT | KMOD_GUI;

/// Whether a key acts by itself: it types no letter, or Ctrl makes it a command.
bool is_command(const SDL_Keysym& key) {
  const bool types = key.sym >= kSpace && key.sym < SDLK_DELETE;
  return !types || key.sym == kSpace || (key.mod & (KMOD_CTRL | KMOD_ALT | KMOD_GUI)) != 0;
}

bool is_modifier(SDL_Scancode code) { return code >= SDL_SCANCODE_LCTRL && code <= SDL_SCANCODE_RGUI; }

}  // namespace

void InputQueue::add_key(const SDL_KeyboardEvent& key) {
  if (key.repeat != 0 || key.keysym.scancode >= SDL_NUM_SCANCODES) return;
  waiting_.push_back({.kind = Event::Kind::kKey,
                      .which = key.keysym.scancode,
                      .down = key.type == SDL_KEYDOWN,
                      .command = is_command(key.keysym) && !is_modifier(key.keysym.scancode),
                      .modifiers = static_cast<std::uint16_t>(key.keysym.mod & kModifiers),
                      .text = {}});
}

void InputQueue::add_button(std::size_t button, bool down) {
  waiting_.push_back({.kind = Event::Kind::kButton,
                      .which = button,
                      .down = down,
                      .command = false,
                      .modifiers = 0,
                      .text = {}});
}

void InputQueue::add_text(const char* text) {
  waiting_.push_back({.kind = Event::Kind::kText,
                      .which = 0,
                      .down = false,
                      .command = false,
                      .modifiers = 0,
                      .text = text});
}

InputQueue::Frame InputQueue::next() {
  std::bitset<SDL_NUM_SCANCODES> changed;
  std::array<bool, kButtons> clicked{};
  bool commanded = false;
  now_.text.clear();
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Event& event = waiting_.front();
    switch (event.kind) {
      case Event::Kind::kKey:
        if (event.command && changed[event.which]) return now_;
        // A modifier that was held for a command is released after the frame of the command.
        if (commanded && !event.command && !event.down && event.modifiers != now_.modifiers) return now_;
        changed[event.which] = true;
        commanded = commanded || (event.command && event.down);
        now_.keys[event.which] = event.down;
        now_.modifiers = event.modifiers;
        break;
      case Event::Kind::kButton:
        if (std::exchange(clicked[event.which], true)) return now_;
        now_.buttons[event.which] = event.down;
        break;
      case Event::Kind::kText:
        if (commanded) return now_;
        now_.text += event.text;
        break;
    }
  }
  return now_;
}

bool EscapeGuard::leaves(std::uint32_t time, bool closes) noexcept {
  if (closes) {
    used_ = true;
    used_at_ = time;
    return false;
  }
  return !used_ || time - used_at_ >= kQuiet;
}

}  // namespace palpate::app
