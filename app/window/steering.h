#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <SDL.h>

#include "run/devices/gamepad.h"
#include "run/devices/mouse.h"

#include "app/session.h"
#include "app/window/orbit_camera.h"

namespace palpate::app {

/// Feeds a session's mouse and gamepad devices from the window's events. All members: [setup], the window's
/// thread.
class Steering final {
 public:
  static constexpr double kNotch = 1e-3;          // m, one notch of the wheel
  static constexpr double kFine = 0.2;            // with Shift held
  static constexpr double kStickSpeed = 0.04;     // m/s, a stick all the way
  static constexpr double kTriggerReach = 25e-3;  // m, the trigger all the way

  Steering() = default;
  ~Steering();
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  /// Looks for what there is to be fed; forgets the session before.
  void take(const Session& session);
  /// Before the session's end: its devices are not fed any more.
  void drop();

  [[nodiscard]] bool mouse_steers() const noexcept { return !mice_.empty(); }
  [[nodiscard]] bool gamepad_steers() const noexcept { return !pads_.empty(); }

  /// The mouse has moved over the picture, by shares of the picture's height.
  void mouse_moved(double right, double up, const OrbitCamera& camera, bool fine);
  /// The wheel was turned by so many notches; away from the user presses.
  void wheel_turned(double notches, bool fine);
  /// The left button is held (jaws closed), or let go.
  void grip(bool closed);
  /// Opens jaws that are closed when no button is held, and the other way round.
  void toggle_rest_of_jaws();
  /// Which of the hands that a mouse can move it moves, from 0.
  void choose_hand(std::size_t which);
  /// A gamepad came or went. SDL_CONTROLLERDEVICEADDED or REMOVED.
  void gamepad_event(const SDL_Event& event);
  /// Once a frame: says all this to the devices.
  void update_devices(const OrbitCamera& camera);
  /// Makes the gamepads rumble: slow motor by the tissue's force [N], quick one by the noise [N].
  void rumble(double tissue_force, double noise);

 private:
  struct Mouse {
    devices::MouseDevice* device = nullptr;
    Quat world_D;        // from the device's axes to the world's
    double scale = 1.0;  // of its translation
    Vec3 axis_W;         // where the tool points
    Vec3 target_D;
    double rest = 0.0;  // gripper while no button is held
    bool held = false;
  };
  struct Pad {
    devices::GamepadDevice* device = nullptr;
    Quat world_D;
    double scale = 1.0;
    Vec3 axis_W;
    double rest = 0.0;
  };

  void update_gamepad(Pad& pad, SDL_GameController* controller, const OrbitCamera& camera) const;

  std::vector<Mouse> mice_;
  std::vector<Pad> pads_;
  std::vector<SDL_GameController*> controllers_;
  std::vector<SDL_JoystickID> ids_;  // of the controllers
  std::size_t chosen_ = 0;
};

}  // namespace palpate::app
