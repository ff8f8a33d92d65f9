#include "app/window/camera_controller.h"

#include <algorithm>
#include <cmath>

namespace palpate::app {
namespace {

constexpr double kTurn = 0.008;    // rad per window unit of mouse motion
constexpr double kKeyTurn = 0.06;  // rad per key press
constexpr double kKeyMove = 0.03;  // fraction of the picture's height per key press
constexpr double kNearer = 0.88;   // factor per notch

}  // namespace

void CameraController::button(const SDL_MouseButtonEvent& button, bool left_turns) noexcept {
  const bool down = button.type == SDL_MOUSEBUTTONDOWN;
  if (button.button == SDL_BUTTON_RIGHT || (button.button == SDL_BUTTON_LEFT && left_turns)) turns_ = down;
  if (button.button == SDL_BUTTON_MIDDLE) moves_ = down;
}

bool CameraController::mouse_moved(std::pair<int, int> way, double picture_height) {
  const auto [right, down] = way;
  const double height = std::max(1.0, picture_height);
  used_ = used_ || busy();
  if (turns_) {
    camera_.orbit(kTurn * right, kTurn * down);
  } else if (moves_) {
    camera_.pan(right / height, -down / height);
  }
  return busy();
}

void CameraController::wheel_turned(double notches) {
  used_ = true;
  camera_.zoom(std::pow(kNearer, notches));
}

void CameraController::arrow_key(const SDL_KeyboardEvent& key) {
  const double right = sign_of(key.keysym.sym, SDLK_RIGHT, SDLK_LEFT);
  const double up = sign_of(key.keysym.sym, SDLK_UP, SDLK_DOWN);
  if (right == 0.0 && up == 0.0) return;
  used_ = true;
  if ((key.keysym.mod & KMOD_SHIFT) != 0) {
    camera_.pan(-kKeyMove * right, -kKeyMove * up);
  } else {
    camera_.orbit(-kKeyTurn * right, kKeyTurn * up);
  }
}

void CameraController::zoom_key(SDL_Keycode key) {
  if (key == SDLK_PLUS || key == SDLK_EQUALS || key == SDLK_KP_PLUS) wheel_turned(1.0);
  if (key == SDLK_MINUS || key == SDLK_KP_MINUS) wheel_turned(-1.0);
}

int sign_of(SDL_Keycode key, SDL_Keycode positive, SDL_Keycode negative) noexcept {
  return (key == positive ? 1 : 0) - (key == negative ? 1 : 0);
}

}  // namespace palpate::app
