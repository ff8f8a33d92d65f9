#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/haptics/workspace.h"
#include "palpate/tick_observer.h"
#include "run/devices/surface_rider.h"
#include "run/devices/window_device.h"

#include "app/session.h"

namespace palpate::app {

/// A hand whose tool is under the pointer of a window or of a page. All members: [setup], one thread.
class MouseHand final {
 public:
  static constexpr int kClickFrames = 2;  // updates that a click or key holds a button at least

  /// @param session outlives this @param device of that hand
  MouseHand(const Session& session, std::size_t hand, devices::MouseDevice& device);

  [[nodiscard]] std::size_t hand() const noexcept { return hand_; }
  [[nodiscard]] devices::SurfaceRider& rider() noexcept { return *rider_; }
  [[nodiscard]] const devices::SurfaceRider& rider() const noexcept { return *rider_; }
  /// Closes the jaws while the button is held, and releases them.
  void grip(bool closed) noexcept;
  /// The button is released elsewhere.
  void let_go() noexcept { held_ = false; }
  /// Opens the jaws if they are closed while no button is held, and the reverse.
  void toggle_rest() noexcept { rest_ = 1.0 - rest_; }
  /// Sends the target to the device. @param shown the newest snapshot @param time since the last call [s]
  /// @param pace of the tool, 0 to 1 @param buttons pressed besides that of the jaws
  void update(const haptics::Snapshot& shown, double time, double pace, std::uint32_t buttons);

 private:
  devices::MouseDevice* device_;
  std::size_t hand_;
  haptics::WorkspaceMapping mapping_;
  double rest_;  // opening of the gripper while no button is held
  std::unique_ptr<devices::SurfaceRider> rider_;
  bool held_ = false;
  int least_frames_ = 0;  // for which a click still counts as held, however short it was
};

/// Sticks and triggers of a gamepad.
struct GamepadState {
  Vec3 way_W = Vec3::Zero();  // where the sticks lead the tool, by their deflection up to 1
  double press = 0.0;         // of the trigger that presses, 0 to 1
  double close = 0.0;         // of the trigger that closes the jaws, 0 to 1
  std::uint32_t buttons = 0;  // one bit per button
};

/// A hand whose tool a gamepad leads. All members: [setup], one thread.
class GamepadHand final {
 public:
  static constexpr double kStickSpeed = 0.04;     // m/s at full deflection of a stick
  static constexpr double kTriggerReach = 25e-3;  // m at full press of the trigger

  /// @param session outlives this @param device of that hand
  GamepadHand(const Session& session, std::size_t hand, devices::GamepadDevice& device);

  [[nodiscard]] std::size_t hand() const noexcept { return hand_; }
  /// Axis of the tool towards its tip, which does not turn.
  [[nodiscard]] const Vec3& axis_W() const noexcept { return axis_W_; }
  /// Opens the jaws if they are closed while no trigger is pressed, and the reverse.
  void toggle_rest() noexcept { rest_ = 1.0 - rest_; }
  /// Sends the state to the device. @param pad null: it is not connected @param buttons pressed besides
  void update(const GamepadState* pad, std::uint32_t buttons);

 private:
  devices::GamepadDevice* device_;
  std::size_t hand_;
  Quat device_W_;  // rotation from the world to the device
  double scale_;
  Vec3 axis_W_;
  double rest_;
};

/// [setup] The hands of a session whose device is a mouse.
[[nodiscard]] std::vector<MouseHand> mice_of(const Session& session);
/// [setup] The hands of a session whose device is a gamepad.
[[nodiscard]] std::vector<GamepadHand> gamepads_of(const Session& session);

}  // namespace palpate::app
