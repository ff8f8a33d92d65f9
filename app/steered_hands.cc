#include "app/steered_hands.h"

#include <algorithm>

#include "core/contact/state.h"
#include "core/haptics/simulation.h"

namespace palpate::app {

namespace {

double rest_of_jaws(const Session& session) { return session.scene().task == scene::Task::kPull ? 1.0 : 0.0; }

/// The hands whose device has this type.
template <typename Hand, typename Device>
std::vector<Hand> hands_of(const Session& session) {
  std::vector<Hand> hands;
  for (std::size_t hand = 0; hand < session.devices().size(); ++hand) {
    auto* device = dynamic_cast<Device*>(session.devices()[hand].get());
    if (device != nullptr) hands.emplace_back(session, hand, *device);
  }
  return hands;
}

}  // namespace

MouseHand::MouseHand(const Session& session, std::size_t hand, devices::MouseDevice& device)
    : device_(&device),
      hand_(hand),
      mapping_(session.world().mappings[hand]),
      rest_(rest_of_jaws(session)),
      rider_(std::make_unique<devices::SurfaceRider>(
          session.world().contact.data().surface, session.scene().tools[hand], session.world().organ_W,
          mapping_.apply(device.start(), device.orientation()), rest_,
          mapping_.scale * devices::TargetFollower::kMaxDistance)) {}

void MouseHand::grip(bool closed) noexcept {
  if (closed) least_frames_ = kClickFrames;
  held_ = closed;
}

void MouseHand::update(const haptics::Snapshot& shown, double time, double pace, std::uint32_t buttons) {
  const bool held = held_ || least_frames_ > 0;
  least_frames_ = std::max(0, least_frames_ - 1);
  const double wanted = held ? 0.0 : rest_;
  const bool there = hand_ < shown.hands;  // false before the first tick
  const bool dragging = there && held && shown.results[hand_].phase == contact::Phase::kPull;
  if (there) {
    const contact::ToolResult& result = shown.results[hand_];
    rider_->feel_needle(result.phase == contact::Phase::kInsert, result.force_W);
  }
  rider_->advance(time, there ? shown.tools[hand_].gripper : wanted, dragging, pace);
  const devices::ToolTarget target = rider_->target();
  const Pose device_W = mapping_.base.inverse();
  devices::MouseInput& input = device_->input().writable();
  input.target_D = device_W * target.tip_W / mapping_.scale;
  input.orientation_D = device_W.rotation * target.orientation_W;
  input.turns = true;
  input.held = rider_->tip() / mapping_.scale;
  input.gripper = wanted;
  input.buttons = (held ? 1U : 0U) | buttons;
  input.present = true;
  device_->input().publish();
}

GamepadHand::GamepadHand(const Session& session, std::size_t hand, devices::GamepadDevice& device)
    : device_(&device),
      hand_(hand),
      device_W_(session.scene().devices[hand].base.rotation.conjugate()),
      scale_(session.scene().devices[hand].workspace_scale),
      axis_W_(device_W_.conjugate() * device.orientation() * Vec3::UnitZ()),
      rest_(rest_of_jaws(session)) {}

void GamepadHand::update(const GamepadState* pad, std::uint32_t buttons) {
  devices::GamepadInput& input = device_->input().writable();
  input = {};
  input.connected = pad != nullptr;
  input.gripper = rest_;
  input.buttons = buttons;
  if (pad != nullptr) {
    input.velocity_D = kStickSpeed / scale_ * (device_W_ * pad->way_W);
    input.advance_D = kTriggerReach * pad->press / scale_ * (device_W_ * axis_W_);
    input.gripper = rest_ * (1.0 - pad->close);
    input.buttons |= pad->buttons;
  }
  device_->input().publish();
}

std::vector<MouseHand> mice_of(const Session& session) {
  return hands_of<MouseHand, devices::MouseDevice>(session);
}

std::vector<GamepadHand> gamepads_of(const Session& session) {
  return hands_of<GamepadHand, devices::GamepadDevice>(session);
}

}  // namespace palpate::app
