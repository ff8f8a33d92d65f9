#pragma once
#include <utility>

#include <SDL.h>

#include "app/window/orbit_camera.h"

namespace palpate::app {

/// Moves the camera by mouse and keys. All members: [setup], the window's thread.
class CameraController final {
 public:
  explicit CameraController(OrbitCamera& camera) : camera_(camera) {}

  /// A mouse button was pressed over the picture, or released anywhere. The right button rotates the view,
  /// the middle button pans it. The left button rotates it too if `left_turns`.
  void button(const SDL_MouseButtonEvent& button, bool left_turns) noexcept;
  [[nodiscard]] bool busy() const noexcept { return turns_ || moves_; }
  /// Whether the user has moved the view since forget().
  [[nodiscard]] bool used() const noexcept { return used_; }
  void forget() noexcept { used_ = false; }
  /// The mouse moved by `way` over a picture of this height [window units]. @return whether that moved the
  /// view
  bool mouse_moved(std::pair<int, int> way, double picture_height);
  /// Zooms in by this number of wheel notches.
  void wheel_turned(double notches);
  /// Arrow keys rotate the view; with Shift they pan it.
  void arrow_key(const SDL_KeyboardEvent& key);
  /// The + and - keys zoom in and out.
  void zoom_key(SDL_Keycode key);

 private:
  OrbitCamera& camera_;
  bool turns_ = false;
  bool moves_ = false;
  bool used_ = false;
};

/// [any] 1 for the key `positive`, -1 for `negative`, 0 for any other.
[[nodiscard]] int sign_of(SDL_Keycode key, SDL_Keycode positive, SDL_Keycode negative) noexcept;

}  // namespace palpate::app
