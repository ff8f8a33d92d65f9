#include "io/scene/make_world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/base/text.h"
#include "core/contact/largest_stiffness.h"
#include "core/geometry/signed_distance.h"
#include "core/haptics/stability.h"
#include "io/scene/device_kinds.h"
#include "io/scene/organ_distance.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

haptics::GateLimits gate_limits(const Scene& scene) {
  const SafetySetup& safety = scene.safety;
  const double period = 1.0 / scene.rate_Hz;
  haptics::GateLimits limits{safety.max_force, safety.max_slew * period, safety.max_torque,
                             safety.max_torque_slew * period, period};
  for (const DeviceSetup& device : scene.devices) {
    limits.continuous_force = std::min(limits.continuous_force, device.abilities.continuous_force);
  }
  return limits;
}

model::Direction direction_of(const Scene& scene) {
  return scene.task == Task::kPull ? model::Direction::kPull : model::Direction::kPress;
}

/// Largest stiffness of a scene's tissue over the uniform tissue's, at any place and for any tool.
double largest_variation(const Scene& scene, const haptics::SimulationWorld& world,
                         const model::TissueParameters& tissue,
                         const std::vector<model::Inclusion>& inclusions) {
  const bool uniform = inclusions.empty() && scene.stiffness.empty();
  if (uniform && tissue.size_exponent == 0.0) return 1.0;
  const contact::TissueLaws laws(tissue, 1.0 / scene.rate_Hz);
  const model::Direction direction = direction_of(scene);
  double scale = 1.0;
  for (const DeviceSetup& device : scene.devices) scale = std::min(scale, device.force_scale);
  const contact::StiffnessReach reach{direction, scene.safety.max_force / scale, haptics::kDepthWithinReach};
  double largest = 0.0;
  for (std::size_t tool = 0; tool < scene.tools.size(); ++tool) {
    const contact::TissueLaws met(model::for_tool(tissue, world.contact.tip_radius(tool)),
                                  1.0 / scene.rate_Hz);
    largest = std::max(
        largest,
        uniform ? contact::largest_tangent(direction == model::Direction::kPull ? met.pull : met.press, reach)
                : contact::largest_stiffness(world.contact, met, inclusions, tool, reach));
  }
  return largest /
         contact::largest_tangent(direction == model::Direction::kPull ? laws.pull : laws.press, reach);
}

/// The tissue with a needle's channel, which holds the shaft sideways, as its tangential stiffness.
model::TissueParameters with_channel(const Scene& scene, model::TissueParameters tissue) {
  double stiffest = tissue.tangential_stiffness();
  for (const geometry::Tool& tool : scene.tools) {
    double left = tool.needle ? tool.needle->length : 0.0;
    double channel = 0.0;  // N/m
    for (const model::TissueLayer& layer : tissue.layers) {
      channel += layer.lateral_stiffness * std::min(left, layer.thickness);
      left = std::max(0.0, left - layer.thickness);
    }
    stiffest = std::max(stiffest, channel);
  }
  if (stiffest > tissue.tangential_stiffness()) {
    tissue.contact.tangential_stiffness = stiffest;
    tissue.contact.friction = std::max(tissue.contact.friction, 1.0);  // also where nothing rubs outside
  }
  return tissue;
}

haptics::StabilityCheck stability_of(const Scene& scene, const DeviceSetup& device,
                                     const model::TissueParameters& tissue, double variation,
                                     const haptics::DeviceMechanics& mechanics) {
  return haptics::check_stability(with_channel(scene, tissue),
                                  {.direction = direction_of(scene),
                                   .period = 1.0 / scene.rate_Hz,
                                   .max_force = scene.safety.max_force / device.force_scale,
                                   .scale = device.workspace_scale * device.force_scale,
                                   .variation = variation,
                                   .slew = scene.safety.max_slew},
                                  mechanics);
}

std::string rounded(double value) { return brief(value, 3); }

/// How the tissue's size exponent changes the force of a tool of this tip radius [m]; empty: not at all.
std::string size_scaling(const model::TissueParameters& tissue, double radius) {
  if (tissue.size_exponent == 0.0) return {};
  return "; size_exponent = " + rounded(tissue.size_exponent) + " multiplies it by " +
         rounded(model::size_factor(tissue.size_exponent, tissue.source->radius, radius));
}

/// A warning when the tissue is stiffer than the device can render; empty when it is not, or that is unknown.
std::string too_stiff(const Scene& scene, const DeviceSetup& device, const model::TissueParameters& tissue,
                      double variation) {
  const haptics::DeviceAbilities& able = device.abilities;
  const double stiffness = stability_of(scene, device, tissue, variation, {}).stiffness;
  if (!(stiffness > able.max_stiffness)) return {};
  const double depth = haptics::depth_of_tangent(
      tissue, direction_of(scene), 1.0 / scene.rate_Hz,
      able.max_stiffness / (variation * device.workspace_scale * device.force_scale));
  return "tissue '" + tissue.name + "' is stiffer than a " + able.model + " can render, " +
         rounded(stiffness) + " N/m instead of at most " + rounded(able.max_stiffness) + " N/m" +
         (std::isfinite(depth) ? ", from a depth of " + rounded(depth / kMillimetre) + " mm" : "") +
         ": the device may tremble there; --fit-device scales the force down to what it can render";
}

std::vector<haptics::WorkspaceMapping> mappings_of(const Scene& scene) {
  std::vector<haptics::WorkspaceMapping> mappings;
  for (const DeviceSetup& device : scene.devices) {
    const DeviceKind* kind = find_device_kind(device.kind);
    mappings.push_back({.scale = device.workspace_scale,
                        .base = device.base,
                        .clutch = device.clutch_button ? 1U << *device.clutch_button : 0U,
                        .held = kind != nullptr && kind->held,
                        .torque = (kind == nullptr || kind->torque) && device.abilities.torque,
                        .force_scale = device.force_scale});
  }
  return mappings;
}

/// Where the scene's tissue is not uniform.
model::TissueVariation variation_of(const Scene& scene) {
  model::TissueVariation variation;
  for (const InclusionSetup& one : scene.inclusions) variation.inclusions.push_back(one.inclusion);
  variation.stiffness = scene.stiffness;
  return variation;
}

}  // namespace

model::OrganMotion organ_motion_of(const Scene& scene) {
  return {scene.organ_motion, geometry::bounds(scene.organ).middle()};
}

haptics::SimulationWorld make_world(const Scene& scene, const contact::Preparation& how) {
  if (scene.tools.empty() || scene.tools.size() != scene.devices.size()) {
    throw InputError("scene: " + std::to_string(scene.tools.size()) + " tools and " +
                     std::to_string(scene.devices.size()) + " devices; there must be one of each a hand");
  }
  const double period = 1.0 / scene.rate_Hz;
  noise::NoiseSettings noise = scene.noise;
  noise.seed = scene.seed;
  const haptics::GateLimits limits = gate_limits(scene);
  noise::validate(noise, scene.rate_Hz, limits.max_sigma());
  const auto distance_of = [&scene](const geometry::TriangleMesh& refined) {
    const geometry::TriangleMesh& organ = scene.organ;  // a fine organ is its own refinement
    const bool is_organ = refined.triangles == organ.triangles && refined.vertices == organ.vertices;
    return is_organ ? organ_distance_of(scene) : geometry::SignedDistance(refined);
  };
  haptics::SimulationWorld world{
      .contact = contact::World(scene.organ, scene.tools, scene.tissue, period, how, variation_of(scene),
                                distance_of),
      .noise = noise::TouchNoise(noise, scene.rate_Hz),
      .limits = limits,
      .mappings = mappings_of(scene),
      .organ_W = scene.organ_pose,
      .rate_Hz = scene.rate_Hz,
      .organ_motion = organ_motion_of(scene),
  };
  return world;
}

std::vector<std::string> apply_device_abilities(Scene& scene, haptics::SimulationWorld& world) {
  std::vector<std::string> remarks;
  for (DeviceSetup& device : scene.devices) {
    const haptics::DeviceAbilities& able = device.abilities;
    const std::string who = "device " + device.kind + ": ";
    if (able.max_force < scene.safety.max_force) {
      remarks.push_back(who + "max_force_N = " + rounded(scene.safety.max_force) + " is lowered to " +
                        rounded(able.max_force) + ", the most that a " + able.model + " gives");
      scene.safety.max_force = able.max_force;
    }
  }
  for (DeviceSetup& device : scene.devices) {
    const haptics::DeviceAbilities& able = device.abilities;
    if (!device.fit) continue;
    device.force_scale = 1.0;
    const double variation = largest_variation(scene, world, scene.tissue, variation_of(scene).inclusions);
    const double stiffness = stability_of(scene, device, scene.tissue, variation, {}).stiffness;
    // A smaller scale lets the tissue be pressed deeper before the gate limits the force.
    constexpr int kMaxSteps = 8;
    for (int i = 0; i < kMaxSteps; ++i) {
      const double felt = stability_of(scene, device, scene.tissue, variation, {}).stiffness;
      if (!(felt > able.max_stiffness)) break;
      device.force_scale *= able.max_stiffness / felt;
    }
    if (device.force_scale < 1.0) {
      remarks.push_back("device " + device.kind + ": the tissue's force is scaled by " +
                        rounded(device.force_scale) + " for the hand (--fit-device), so that its " +
                        rounded(stiffness) + " N/m become the " + rounded(able.max_stiffness) +
                        " N/m that a " + able.model + " can render");
    }
  }
  world.limits = gate_limits(scene);
  world.mappings = mappings_of(scene);
  noise::validate(world.noise.settings(), scene.rate_Hz, world.limits.max_sigma());
  return remarks;
}

std::vector<std::string> stability_remarks(const Scene& scene, const haptics::SimulationWorld& world) {
  return stability_remarks(scene, world, scene.tissue, variation_of(scene).inclusions);
}

std::vector<std::string> radius_remarks(const Scene& scene, const haptics::SimulationWorld& world) {
  std::vector<std::string> remarks;
  if (!scene.tissue.source || !(scene.tissue.source->radius > 0.0)) return remarks;
  const double fitted = scene.tissue.source->radius;
  const auto in_mm = [](double radius) { return shortest(std::round(radius * 1e5) / 1e2) + " mm"; };
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    const double radius = world.contact.tip_radius(hand);
    if (!(radius > 2.0 * fitted || 2.0 * radius < fitted)) continue;
    remarks.push_back("tissue '" + scene.tissue.name + "' was fitted with an indenter of " + in_mm(fitted) +
                      " radius, the tip of '" + scene.tools[hand].name + "' has " + in_mm(radius) +
                      ": more than twofold apart, so the force may be wrong" +
                      size_scaling(scene.tissue, radius));
  }
  return remarks;
}

std::vector<std::string> overlap_remarks(const Scene& scene) {
  std::vector<std::string> remarks;
  for (auto one = scene.inclusions.begin(); one != scene.inclusions.end(); ++one) {
    for (auto other = std::next(one); other != scene.inclusions.end(); ++other) {
      if (!one->visible || !other->visible) continue;
      const double apart = (one->inclusion.centre_S - other->inclusion.centre_S).norm();
      const double radii = one->inclusion.radius + other->inclusion.radius;
      if (!(apart < radii)) continue;
      remarks.push_back("inclusions '" + one->name + "' and '" + other->name +
                        "' overlap, their centres are " + rounded(apart / kMillimetre) +
                        " mm apart, less than the sum of their radii, " + rounded(radii / kMillimetre) +
                        " mm: their factors multiply there, up to a cap");
    }
  }
  return remarks;
}

std::unique_ptr<haptics::ParameterUpdates> make_parameter_updates(const Scene& scene,
                                                                  const haptics::SimulationWorld& world) {
  return std::make_unique<haptics::ParameterUpdates>(
      world, scene.tissue,
      [&scene, &world](const model::TissueParameters& tissue,
                       const std::vector<model::Inclusion>& inclusions) {
        return stability_remarks(scene, world, tissue, inclusions);
      });
}

std::vector<std::string> stability_remarks(const Scene& scene, const haptics::SimulationWorld& world,
                                           const model::TissueParameters& tissue,
                                           const std::vector<model::Inclusion>& inclusions) {
  std::vector<std::string> remarks;
  std::optional<double> variation;  // one for all devices
  for (const DeviceSetup& device : scene.devices) {
    const DeviceKind* kind = find_device_kind(device.kind);
    if (kind == nullptr || !kind->held) continue;
    const std::string who = "device " + device.kind + ": ";
    const DeviceDynamics& known = device.dynamics;
    if (!variation) variation = largest_variation(scene, world, tissue, inclusions);
    const std::string stiff = too_stiff(scene, device, tissue, *variation);
    if (!stiff.empty()) remarks.push_back(who + stiff);
    if (!known.damping || !known.friction || !known.resolution) {
      const std::string note = haptics::slew_note(stability_of(scene, device, tissue, *variation, {}));
      if (!note.empty()) remarks.push_back(who + note);
      if (std::isfinite(device.abilities.max_stiffness)) continue;  // checked above, by the maker's figure
      remarks.push_back(who +
                        "its stability with this tissue was not checked: give damping_N_s_per_m, "
                        "friction_N and resolution_mm under [device]");
      continue;
    }
    const double mass = device.kind == "emulated" ? device.emulated.mass : 0.0;
    const haptics::DeviceMechanics mechanics{*known.damping, *known.friction, *known.resolution, mass};
    const haptics::StabilityCheck check = stability_of(scene, device, tissue, *variation, mechanics);
    for (const std::string& warning : haptics::stability_warnings(check, mechanics)) {
      remarks.push_back(who + warning);
    }
  }
  return remarks;
}

}  // namespace palpate::scene
