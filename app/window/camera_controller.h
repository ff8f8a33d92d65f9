#pragma once
#include <utility>

#include <SDL.h>

#include "app/window/orbit_camera.h"

namespace palpate::app {

/// What mouse and keys do to the view. All members: [setup], the window's thread.
class CameraController final {
 public:
  explicit CameraController(OrbitCamera& camera) : camera_(camera) {}

  /// A button pressed over the picture, or released anywhere: with the right one, and the left one where
  /// `left_turns`, the mouse turns the view, with the middle one it moves it in its plane.
  void button(const SDL_MouseButtonEvent& button, bool left_turns) noexcept;
  [[nodiscard]] bool busy() const noexcept { return turns_ || moves_; }
  /// A way of the mouse over a picture so high [window units both]. @return whether it was the view's
  bool mouse_moved(std::pair<int, int> way, double picture_height);
  /// Nearer by the wheel's notches.
  void wheel_turned(double notches);
  /// Arrows go round, with Shift they move; + and - come nearer and go back.
  void arrow_key(const SDL_KeyboardEvent& key);
  void zoom_key(SDL_Keycode key);

 private:
  OrbitCamera& camera_;
  bool turns_ = false;
  bool moves_ = false;
};

/// [any] 1, -1 or 0 for a pair of keys.
[[nodiscard]] int sign_of(SDL_Keycode key, SDL_Keycode positive, SDL_Keycode negative) noexcept;

}  // namespace palpate::app
