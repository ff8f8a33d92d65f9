#include "io/scene/make_world.h"

#include <cmath>
#include <string>

#include "core/base/text.h"
#include "core/haptics/stability.h"
#include "io/scene/device_kinds.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

haptics::GateLimits gate_limits(const SafetySetup& safety, double period) {
  return {safety.max_force, safety.max_slew * period, safety.max_torque, safety.max_torque_slew * period,
          period};
}

}  // namespace

model::OrganMotion organ_motion_of(const Setup& setup) {
  return {setup.organ_motion, geometry::bounds(setup.organ).middle()};
}

haptics::SimulationWorld make_world(const Setup& setup, const contact::Preparation& how) {
  if (setup.tools.empty() || setup.tools.size() != setup.devices.size()) {
    throw InputError("scene: " + std::to_string(setup.tools.size()) + " tools and " +
                     std::to_string(setup.devices.size()) + " devices; there must be one of each a hand");
  }
  const double period = 1.0 / setup.rate_Hz;
  noise::NoiseSettings noise = setup.noise;
  noise.seed = setup.seed;
  const haptics::GateLimits limits = gate_limits(setup.safety, period);
  noise::validate(noise, setup.rate_Hz, limits.most_sigma());
  haptics::SimulationWorld world{
      .contact = contact::World(setup.organ, setup.tools, setup.tissue, period, how),
      .noise = noise::TouchNoise(noise, setup.rate_Hz),
      .limits = limits,
      .mappings = {},
      .organ_W = setup.organ_pose,
      .rate_Hz = setup.rate_Hz,
      .organ_motion = organ_motion_of(setup),
  };
  for (const DeviceSetup& device : setup.devices) {
    const DeviceKind* kind = find_device_kind(device.kind);
    world.mappings.push_back({.scale = device.workspace_scale,
                              .base = device.base,
                              .clutch = device.clutch_button ? 1U << *device.clutch_button : 0U,
                              .held = kind != nullptr && kind->held,
                              .torque = kind == nullptr || kind->torque});
  }
  return world;
}

std::vector<std::string> stability_remarks(const Setup& setup) {
  return stability_remarks(setup, setup.tissue);
}

std::vector<std::string> radius_remarks(const Setup& setup, const haptics::SimulationWorld& world) {
  std::vector<std::string> remarks;
  if (!setup.tissue.source || !(setup.tissue.source->radius > 0.0)) return remarks;
  const double fitted = setup.tissue.source->radius;
  const auto in_mm = [](double radius) { return shortest(std::round(radius * 1e5) / 1e2) + " mm"; };
  for (std::size_t hand = 0; hand < setup.tools.size(); ++hand) {
    const double radius = world.contact.tip_radius(hand);
    if (!(radius > 2.0 * fitted || 2.0 * radius < fitted)) continue;
    remarks.push_back("tissue '" + setup.tissue.name + "' was fitted with an indenter of " + in_mm(fitted) +
                      " radius, the tip of '" + setup.tools[hand].name + "' has " + in_mm(radius) +
                      ": more than twofold apart, so the force may be wrong");
  }
  return remarks;
}

std::unique_ptr<haptics::LiveChanges> live_changes(const Setup& setup,
                                                   const haptics::SimulationWorld& world) {
  return std::make_unique<haptics::LiveChanges>(
      world, setup.tissue,
      [&setup](const model::TissueParameters& tissue) { return stability_remarks(setup, tissue); });
}

std::vector<std::string> stability_remarks(const Setup& setup, const model::TissueParameters& tissue) {
  const auto direction = setup.task == Task::kPull ? model::Direction::kPull : model::Direction::kPress;
  std::vector<std::string> remarks;
  for (const DeviceSetup& device : setup.devices) {
    const DeviceKind* kind = find_device_kind(device.kind);
    if (kind == nullptr || !kind->held) continue;
    const std::string who = "device " + device.kind + ": ";
    const DeviceDynamics& known = device.dynamics;
    if (!known.damping || !known.friction || !known.resolution) {
      remarks.push_back(who +
                        "its stability with this tissue was not checked: give damping_N_s_per_m, "
                        "friction_N and resolution_mm under [device]");
      continue;
    }
    const haptics::DeviceMechanics mechanics{*known.damping, *known.friction, *known.resolution};
    const haptics::StabilityCheck check = haptics::check_stability(
        tissue, direction, 1.0 / setup.rate_Hz, setup.safety.max_force, device.workspace_scale, mechanics);
    for (const std::string& warning : haptics::stability_warnings(check, mechanics)) {
      remarks.push_back(who + warning);
    }
  }
  return remarks;
}

}  // namespace palpate::scene
