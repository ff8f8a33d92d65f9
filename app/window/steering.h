#pragma once
#include <cstdint>
#include <vector>

#include <SDL.h>

#include "palpate/tick_observer.h"

#include "app/session.h"
#include "app/steered_hands.h"
#include "app/window/orbit_camera.h"

namespace palpate::app {

/// Sends the window's mouse and gamepad events to the session's devices. All members: [setup], the window's
/// thread.
class Steering final {
 public:
  static constexpr double kNotch = 1e-3;  // m per notch of the wheel
  static constexpr double kFine = 0.2;    // factor while Shift is held

  Steering() = default;
  ~Steering();
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  /// Uses the mouse and gamepad devices of this session instead of the previous one's.
  void take(const Session& session);
  /// Stops using the session's devices. Call before the session ends.
  void drop();

  [[nodiscard]] bool mouse_steers() const noexcept { return !mice_.empty(); }
  [[nodiscard]] bool gamepad_steers() const noexcept { return !pads_.empty(); }

  /// The pointer is over the picture: the tool rides on the organ's surface under it. Call once per frame.
  void point_at(const geometry::Ray& ray_W);
  /// The pointer is on a panel, or turns the view: the tool stays where it is.
  void freeze();
  /// Changes the set depth by notches of the wheel; positive presses.
  void wheel_turned(double notches, bool fine);
  /// Lifts the tool off the organ and leaves it there, or brings it back under the pointer.
  void toggle_parked();
  /// Set depth of the mouse's tool under the surface [m]; negative: height above it.
  [[nodiscard]] double set_depth() const;
  /// Closes the jaws while the left button is held, and releases them.
  void grip(bool closed);
  /// Presses a button of the mouse devices and gamepads for some frames. @param button bit of
  /// DeviceState::buttons
  void press_button(std::uint32_t button);
  /// Sets the pace of the tool that follows the mouse, 0 to 1.
  void set_gain(double gain) noexcept { gain_ = gain; }
  /// Opens the jaws if they are closed while no button is held, and the reverse.
  void toggle_rest_of_jaws();
  /// Selects the hand that the mouse moves, counted from 0 among those with a mouse device.
  void choose_hand(std::size_t which);
  /// Adds or removes a gamepad (SDL_CONTROLLERDEVICEADDED or REMOVED).
  void gamepad_event(const SDL_Event& event);
  /// Sends targets and inputs to the devices. Call once per frame. @param shown the newest snapshot
  /// @param time since the last call [s]
  void update_devices(const OrbitCamera& camera, const haptics::Snapshot& shown, double time);
  /// Sets the gamepads' vibration: slow motor from the tissue force [N], fast motor from the noise [N].
  void rumble(double tissue_force, double noise);

 private:
  std::vector<MouseHand> mice_;
  std::vector<GamepadHand> pads_;
  std::vector<SDL_GameController*> controllers_;
  std::vector<SDL_JoystickID> ids_;  // of the controllers
  std::size_t chosen_ = 0;
  double gain_ = 1.0;          // of the mouse
  std::uint32_t pressed_ = 0;  // buttons that press_button() holds
  int pressed_frames_ = 0;     // how long still
};

}  // namespace palpate::app
