#include "app/window/steering.h"

#include <algorithm>
#include <cmath>

#include "core/contact/state.h"
#include "core/haptics/simulation.h"

namespace palpate::app {
namespace {

constexpr double kDeadZone = 0.15;  // fraction of a stick's range

double axis_of(SDL_GameController* controller, SDL_GameControllerAxis axis) {
  const double value = SDL_GameControllerGetAxis(controller, axis) / 32767.0;
  const double beyond = std::max(0.0, std::abs(value) - kDeadZone) / (1.0 - kDeadZone);
  return std::copysign(std::min(1.0, beyond), value);
}

}  // namespace

Steering::~Steering() {
  for (SDL_GameController* controller : controllers_) SDL_GameControllerClose(controller);
}

void Steering::take(const Session& session) {
  drop();
  for (std::size_t hand = 0; hand < session.devices().size(); ++hand) {
    haptics::Device* device = session.devices()[hand].get();
    const scene::DeviceSetup& how = session.scene().devices[hand];
    if (auto* mouse = dynamic_cast<devices::MouseDevice*>(device)) {
      const double gripper = session.scene().task == scene::Task::kPull ? 1.0 : 0.0;
      const haptics::SimulationWorld& world = session.world();
      const haptics::WorkspaceMapping& mapping = world.mappings[hand];
      mice_.push_back({mouse, hand, mapping,
                       std::make_unique<devices::SurfaceRider>(
                           world.contact.data().surface, session.scene().tools[hand], world.organ_W,
                           mapping.apply(mouse->start(), mouse->orientation()), gripper,
                           mapping.scale * devices::TargetFollower::kMaxDistance),
                       gripper, false});
    }
    if (auto* pad = dynamic_cast<devices::GamepadDevice*>(device)) {
      const double gripper = session.scene().task == scene::Task::kPull ? 1.0 : 0.0;
      pads_.push_back({pad, how.base.rotation, how.workspace_scale,
                       Vec3(how.base.rotation * pad->orientation() * Vec3::UnitZ()), gripper});
    }
  }
}

void Steering::drop() {
  mice_.clear();
  pads_.clear();
  chosen_ = 0;
}

void Steering::point_at(const geometry::Ray& ray_W) {
  if (!mice_.empty()) mice_[chosen_].rider->point_at(ray_W);
}

void Steering::freeze() {
  for (Mouse& mouse : mice_) mouse.rider->freeze();
}

void Steering::wheel_turned(double notches, bool fine) {
  if (!mice_.empty()) mice_[chosen_].rider->press(notches * kNotch * (fine ? kFine : 1.0));
}

void Steering::toggle_parked() {
  if (mice_.empty()) return;
  devices::SurfaceRider& rider = *mice_[chosen_].rider;
  rider.park(!rider.parked());
}

double Steering::set_depth() const { return mice_.empty() ? 0.0 : mice_[chosen_].rider->depth(); }

void Steering::grip(bool closed) {
  if (mice_.empty()) return;
  Mouse& mouse = mice_[chosen_];
  if (closed) mouse.least_frames = kClickFrames;
  mouse.held = closed;
}

void Steering::toggle_rest_of_jaws() {
  if (!mice_.empty()) mice_[chosen_].rest = 1.0 - mice_[chosen_].rest;
  for (Pad& pad : pads_) pad.rest = 1.0 - pad.rest;
}

void Steering::choose_hand(std::size_t which) {
  if (which >= mice_.size()) return;
  freeze();
  for (Mouse& mouse : mice_) mouse.held = false;  // the button's release will go to the other hand
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
  pressed_frames_ = kClickFrames + 1;
}

void Steering::update_devices(const OrbitCamera& camera, const haptics::Snapshot& shown, double time) {
  if (pressed_frames_ > 0 && --pressed_frames_ == 0) pressed_ = 0;
  for (Mouse& mouse : mice_) update_mouse(mouse, shown, time);
  for (std::size_t i = 0; i < pads_.size(); ++i) {
    update_gamepad(pads_[i], i < controllers_.size() ? controllers_[i] : nullptr, camera);
  }
}

void Steering::update_mouse(Mouse& mouse, const haptics::Snapshot& shown, double time) const {
  const bool held = mouse.held || mouse.least_frames > 0;
  mouse.least_frames = std::max(0, mouse.least_frames - 1);
  const double wanted = held ? 0.0 : mouse.rest;
  const bool there = mouse.hand < shown.hands;  // false before the first tick
  const bool dragging = there && held && shown.results[mouse.hand].phase == contact::Phase::kPull;
  devices::SurfaceRider& rider = *mouse.rider;
  if (there) {
    const contact::ToolResult& result = shown.results[mouse.hand];
    rider.feel_needle(result.phase == contact::Phase::kInsert, result.force_W);
  }
  rider.advance(time, there ? shown.tools[mouse.hand].gripper : wanted, dragging, gain_);
  const devices::ToolTarget target = rider.target();
  const Pose device_W = mouse.mapping.base.inverse();
  devices::MouseInput& input = mouse.device->input().writable();
  input.target_D = device_W * target.tip_W / mouse.mapping.scale;
  input.orientation_D = device_W.rotation * target.orientation_W;
  input.turns = true;
  input.held = rider.tip() / mouse.mapping.scale;
  input.gripper = wanted;
  input.buttons = (held ? 1U : 0U) | pressed_;
  input.present = true;
  mouse.device->input().publish();
}

void Steering::update_gamepad(Pad& pad, SDL_GameController* controller, const OrbitCamera& camera) const {
  devices::GamepadInput input;
  input.connected = controller != nullptr;
  input.gripper = pad.rest;
  input.buttons = pressed_;
  if (controller != nullptr) {
    const ToolPlane plane = plane_across(pad.axis_W, camera);
    const Vec3 way_W = axis_of(controller, SDL_CONTROLLER_AXIS_LEFTX) * plane.right -
                       axis_of(controller, SDL_CONTROLLER_AXIS_LEFTY) * plane.away +
                       axis_of(controller, SDL_CONTROLLER_AXIS_RIGHTY) * pad.axis_W;
    const Quat device_W = pad.world_D.conjugate();
    const double pressed = axis_of(controller, SDL_CONTROLLER_AXIS_TRIGGERRIGHT);
    input.velocity_D = kStickSpeed / pad.scale * (device_W * way_W);
    input.advance_D = kTriggerReach * pressed / pad.scale * (device_W * pad.axis_W);
    for (const int button : {SDL_CONTROLLER_BUTTON_A, SDL_CONTROLLER_BUTTON_B, SDL_CONTROLLER_BUTTON_X,
                             SDL_CONTROLLER_BUTTON_Y}) {
      const auto down =
          SDL_GameControllerGetButton(controller, static_cast<SDL_GameControllerButton>(button));
      if (down != 0) input.buttons |= 1U << button;
    }
    input.gripper = pad.rest * (1.0 - axis_of(controller, SDL_CONTROLLER_AXIS_TRIGGERLEFT));
  }
  pad.device->input().writable() = input;
  pad.device->input().publish();
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
