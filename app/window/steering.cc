#include "app/window/steering.h"

#include <algorithm>
#include <cmath>

namespace palpate::app {
namespace {

constexpr double kDeadZone = 0.15;  // fraction of a stick's range

double axis_of(SDL_GameController* controller, SDL_GameControllerAxis axis) {
  const double value = SDL_GameControllerGetAxis(controller, axis) / 32767.0;
  const double beyond = std::max(0.0, std::abs(value) - kDeadZone) / (1.0 - kDeadZone);
  return std::copysign(std::min(1.0, beyond), value);
}

GamepadState state_of(SDL_GameController* controller, const Vec3& axis_W, const OrbitCamera& camera) {
  const ToolPlane plane = plane_across(axis_W, camera);
  GamepadState state;
  state.way_W = axis_of(controller, SDL_CONTROLLER_AXIS_LEFTX) * plane.right -
                axis_of(controller, SDL_CONTROLLER_AXIS_LEFTY) * plane.away +
                axis_of(controller, SDL_CONTROLLER_AXIS_RIGHTY) * axis_W;
  state.press = axis_of(controller, SDL_CONTROLLER_AXIS_TRIGGERRIGHT);
  state.close = axis_of(controller, SDL_CONTROLLER_AXIS_TRIGGERLEFT);
  for (const int button :
       {SDL_CONTROLLER_BUTTON_A, SDL_CONTROLLER_BUTTON_B, SDL_CONTROLLER_BUTTON_X, SDL_CONTROLLER_BUTTON_Y}) {
    const auto down = SDL_GameControllerGetButton(controller, static_cast<SDL_GameControllerButton>(button));
    if (down != 0) state.buttons |= 1U << button;
  }
  return state;
}

}  // namespace

Steering::~Steering() {
  for (SDL_GameController* controller : controllers_) SDL_GameControllerClose(controller);
}

void Steering::take(const Session& session) {
  drop();
  mice_ = mice_of(session);
  pads_ = gamepads_of(session);
}

void Steering::drop() {
  mice_.clear();
  pads_.clear();
  chosen_ = 0;
}

void Steering::point_at(const geometry::Ray& ray_W) {
  if (!mice_.empty()) mice_[chosen_].rider().point_at(ray_W);
}

void Steering::freeze() {
  for (MouseHand& mouse : mice_) mouse.rider().freeze();
}

void Steering::wheel_turned(double notches, bool fine) {
  if (!mice_.empty()) mice_[chosen_].rider().press(notches * kNotch * (fine ? kFine : 1.0));
}

void Steering::toggle_parked() {
  if (mice_.empty()) return;
  devices::SurfaceRider& rider = mice_[chosen_].rider();
  rider.park(!rider.parked());
}

double Steering::set_depth() const { return mice_.empty() ? 0.0 : mice_[chosen_].rider().depth(); }

void Steering::grip(bool closed) {
  if (!mice_.empty()) mice_[chosen_].grip(closed);
}

void Steering::toggle_rest_of_jaws() {
  if (!mice_.empty()) mice_[chosen_].toggle_rest();
  for (GamepadHand& pad : pads_) pad.toggle_rest();
}

void Steering::choose_hand(std::size_t which) {
  if (which >= mice_.size()) return;
  freeze();
  for (MouseHand& mouse : mice_) mouse.let_go();  // the button's release will go to the other hand
  chosen_ = which;
}

void Steering::gamepad_event(const SDL_Event& event) {
  if (event.type == SDL_CONTROLLERDEVICEADDED) {
    SDL_GameController* controller = SDL_GameControllerOpen(event.cdevice.which);
    if (controller == nullptr) return;
    const SDL_JoystickID id = SDL_JoystickInstanceID(SDL_GameControllerGetJoystick(controller));
    if (std::find(ids_.begin(), ids_.end(), id) != ids_.end()) {
      SDL_GameControllerClose(controller);  // already open; SDL counts how often it is opened
      return;
    }
    controllers_.push_back(controller);
    ids_.push_back(id);
    return;
  }
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (ids_[i] != event.cdevice.which) continue;
    SDL_GameControllerClose(controllers_[i]);
    controllers_.erase(controllers_.begin() + static_cast<std::ptrdiff_t>(i));
    ids_.erase(ids_.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

void Steering::press_button(std::uint32_t button) {
  pressed_ = 1U << button;
  pressed_frames_ = MouseHand::kClickFrames + 1;
}

void Steering::update_devices(const OrbitCamera& camera, const haptics::Snapshot& shown, double time) {
  if (pressed_frames_ > 0 && --pressed_frames_ == 0) pressed_ = 0;
  for (MouseHand& mouse : mice_) mouse.update(shown, time, gain_, pressed_);
  for (std::size_t i = 0; i < pads_.size(); ++i) {
    const bool connected = i < controllers_.size();
    const GamepadState state =
        connected ? state_of(controllers_[i], pads_[i].axis_W(), camera) : GamepadState();
    pads_[i].update(connected ? &state : nullptr, pressed_);
  }
}

void Steering::rumble(double tissue_force, double noise) {
  constexpr double kAllForce = 5.0;    // N, tissue force for the slow motor's maximum
  constexpr double kAllNoise = 30e-3;  // N, root mean square of the noise for the fast motor's maximum
  constexpr Uint32 kLasting = 150;     // ms; the next frame renews it earlier
  const auto strength = [](double share) {
    return static_cast<Uint16>(65535.0 * std::clamp(share, 0.0, 1.0));
  };
  for (std::size_t i = 0; i < pads_.size() && i < controllers_.size(); ++i) {
    SDL_GameControllerRumble(controllers_[i], strength(tissue_force / kAllForce), strength(noise / kAllNoise),
                             kLasting);
  }
}

}  // namespace palpate::app
