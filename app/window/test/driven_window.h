#pragma once
// A window that a test drives by synthetic events.
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include <SDL.h>

#include "app/window/window.h"

namespace palpate::app {

/// The window on a session of its own, and what a user does with it.
class DrivenWindow final {
 public:
  explicit DrivenWindow(const scene::Request& request, WindowOptions options = {})
      : session_(prepare(request, options.duration_s, true)),
        window_(session_, request, std::move(options)) {}

  [[nodiscard]] Window& window() noexcept { return window_; }
  [[nodiscard]] Session& session() noexcept { return session_; }

  /// Frames until `done` says so. @return whether it did within the time; the time is for slow machines
  bool until(const std::function<bool()>& done, double seconds = 60.0) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!done()) {
      if (!alive_ || std::chrono::steady_clock::now() > give_up) return done();
      alive_ = window_.frame();
    }
    return true;
  }
  void frames(int number) {
    for (int i = 0; i < number && alive_; ++i) alive_ = window_.frame();
  }
  /// Whether the last frame said that the window stays.
  [[nodiscard]] bool alive() const noexcept { return alive_; }

  /// Pressed for a frame.
  void key(SDL_Keycode which, Uint16 modifiers = KMOD_NONE) {
    for (const Uint32 type : {SDL_KEYDOWN, SDL_KEYUP}) {
      SDL_Event event{};
      event.type = type;
      event.key.keysym.sym = which;
      event.key.keysym.scancode = SDL_GetScancodeFromKey(which);
      event.key.keysym.mod = modifiers;
      SDL_PushEvent(&event);
      frames(1);
    }
  }
  void move(int x, int y) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.x = x;
    event.motion.y = y;
    event.motion.xrel = x - x_;
    event.motion.yrel = y - y_;
    SDL_PushEvent(&event);
    x_ = x;
    y_ = y;
  }
  void button(Uint8 which, bool down) const {
    SDL_Event event{};
    event.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
    event.button.button = which;
    event.button.x = x_;
    event.button.y = y_;
    SDL_PushEvent(&event);
  }
  static void wheel(int notches) {
    SDL_Event event{};
    event.type = SDL_MOUSEWHEEL;
    event.wheel.y = notches;
    SDL_PushEvent(&event);
  }
  static void drop(const std::string& file) {
    SDL_Event event{};
    event.type = SDL_DROPFILE;
    event.drop.file = SDL_strdup(file.c_str());
    SDL_PushEvent(&event);
  }
  static void close() {
    SDL_Event event{};
    event.type = SDL_WINDOWEVENT;
    event.window.event = SDL_WINDOWEVENT_CLOSE;
    SDL_PushEvent(&event);
  }
  void resize(int width, int height) { SDL_SetWindowSize(SDL_GetWindowFromID(1), width, height); }
  /// To the middle of the picture.
  void move_to_picture() {
    const Rectangle& place = window_.layout().picture;
    move(static_cast<int>(place.x + 0.5F * place.width), static_cast<int>(place.y + 0.5F * place.height));
  }
  WindowOutcome finish() { return window_.finish(); }

 private:
  Session session_;
  Window window_;
  bool alive_ = true;
  int x_ = 0;
  int y_ = 0;
};

}  // namespace palpate::app
