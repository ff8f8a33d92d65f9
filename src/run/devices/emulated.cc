#include "run/devices/emulated.h"

#include <cmath>

#include "palpate/error.h"
#include "run/devices/path_end.h"

namespace palpate::devices {
namespace {

void require_not_negative(const char* field, double value) {
  if (!(value >= 0.0 && std::isfinite(value))) throw ParameterError(field, value, "a finite number >= 0");
}

HandMassParameters mass_of(const scene::DeviceSetup& setup) {
  const scene::EmulatedHand& hand = setup.emulated;
  const HandMassParameters parameters{hand.mass, setup.dynamics.damping.value_or(scene::kEmulatedDamping),
                                      setup.dynamics.friction.value_or(scene::kEmulatedFriction),
                                      hand.grip.stiffness, hand.grip.damping};
  if (!(hand.mass > 0.0 && std::isfinite(hand.mass))) {
    throw ParameterError("mass_kg", hand.mass, "a finite number > 0");
  }
  require_not_negative("damping_N_s_per_m", parameters.damping);
  require_not_negative("friction_N", parameters.friction);
  require_not_negative("grip_N_per_m", parameters.grip_stiffness);
  require_not_negative("grip_N_s_per_m", parameters.grip_damping);
  return parameters;
}

double resolution_of(const scene::DeviceSetup& setup) {
  constexpr double kPerMetre = 1e3;  // mm per m; scenes give mm
  const double resolution = setup.dynamics.resolution.value_or(scene::kEmulatedResolution);
  require_not_negative("resolution_mm", kPerMetre * resolution);
  return resolution;
}

}  // namespace

EmulatedDevice::EmulatedDevice(scene::ToolPath path, const scene::DeviceSetup& setup, double rate_Hz)
    : path_(std::move(path)),
      resolution_(resolution_of(setup)),
      rate_Hz_(rate_Hz),
      velocity_weight_(1.0 / (1.0 + kVelocityFilter * rate_Hz)),
      faults_(setup.emulated.faults, rate_Hz),
      hand_(mass_of(setup), path_.at(0.0).position),
      target_(path_.at(0.0).position) {}

Vec3 EmulatedDevice::force_on_hand() const noexcept {
  const bool let_go = static_cast<double>(refused_) > kOwnWatchdog * rate_Hz_;
  const bool off = stopped_.load(std::memory_order_relaxed) ||
                   (started_ && faults_.is_active(scene::EmulatedFaultKind::kForceOff, tick_));
  return let_go || off ? Vec3::Zero() : force_;
}

Vec3 EmulatedDevice::encoder_reading() const noexcept {
  if (resolution_ == 0.0) return hand_.position();
  return ((hand_.position() / resolution_).array() + 0.5).floor().matrix() * resolution_;
}

haptics::DeviceState EmulatedDevice::read(std::uint64_t tick, double time) noexcept {
  const scene::PathRow wanted = path_.at(time);
  if (!started_) {
    started_ = true;
    reading_ = encoder_reading();
  } else if (tick > tick_) {
    hand_.advance(target_, wanted.position, force_on_hand(), 1.0 / rate_Hz_);
    const Vec3 before = reading_;
    reading_ = encoder_reading();
    velocity_ += velocity_weight_ * ((reading_ - before) * rate_Hz_ - velocity_);
  }
  tick_ = tick;
  target_ = wanted.position;
  haptics::DeviceState sample;
  sample.position_D = reading_;
  sample.orientation_D = wanted.orientation;
  sample.velocity_D = velocity_;
  sample.gripper = wanted.gripper;
  sample.buttons = wanted.buttons;
  if (const auto fault = faults_.first_active(tick)) {
    last_fault_.store(static_cast<int>(*fault), std::memory_order_relaxed);
  }
  return faults_.with_faults(tick, sample);
}

bool EmulatedDevice::write(const haptics::ForceCommand& command_D) noexcept {
  if (faults_.is_active(scene::EmulatedFaultKind::kRefuse, tick_)) {
    ++refused_;
    return false;
  }
  refused_ = 0;
  force_ = command_D.force;
  stopped_.store(false, std::memory_order_relaxed);
  return true;
}

std::uint64_t EmulatedDevice::last_tick(double rate_Hz) const noexcept {
  return last_tick_of(path_, rate_Hz);
}

std::string EmulatedDevice::last_error() const {
  const int fault = last_fault_.load(std::memory_order_relaxed);
  if (fault < 0) return {};
  return "the scene's fault \"" + std::string(scene::name_of(static_cast<scene::EmulatedFaultKind>(fault))) +
         "\" of the emulated device";
}

}  // namespace palpate::devices
