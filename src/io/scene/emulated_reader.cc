#include "io/scene/emulated_reader.h"

#include <string>

#include "io/scene/names.h"
#include "io/scene/scene_keys.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr double kMillisecond = 1e-3;  // s

HandGrip read_grip(const TomlTable& device) {
  HandGrip grip = kFirmGrip;
  const std::optional<std::string> word = device.text("grip");
  if (word) {
    for (const char* key : {"grip_N_per_m", "grip_N_s_per_m"}) {
      if (device.number(key)) device.fail(key, "excludes grip, give only one of them");
    }
    if (*word != "light" && *word != "firm") device.fail("grip", "must be light or firm");
    return *word == "light" ? kLightGrip : kFirmGrip;
  }
  grip.stiffness = number_in(device, "grip_N_per_m").value_or(grip.stiffness);
  grip.damping = number_in(device, "grip_N_s_per_m").value_or(grip.damping);
  return grip;
}

EmulatedFault read_fault(const TomlTable& table) {
  table.allow_only(keys_in("device.fault"));
  std::vector<std::string> names;
  for (const EmulatedFaultName& known : emulated_fault_names()) names.emplace_back(known.name);
  const std::string want = "must be " + alternatives(names);
  const std::optional<std::string> word = table.text("kind");
  if (!word) table.fail_missing("kind", want);
  const std::optional<EmulatedFaultKind> kind = find_emulated_fault(*word);
  if (!kind) table.fail("kind", want);
  EmulatedFault fault;
  fault.kind = *kind;
  fault.time = table.required_number("time_s", find_scene_key("", table.field("time_s")).range);
  fault.duration = number_in(table, "duration_s").value_or(fault.duration);
  if (const auto age = number_in(table, "age_ms")) {
    if (fault.kind != EmulatedFaultKind::kLate) table.fail("age_ms", "is only for kind = \"late\"");
    fault.age = *age * kMillisecond;
  }
  return fault;
}

constexpr EmulatedFaultName kFaultNames[] = {
    {"freeze", EmulatedFaultKind::kFreeze},      {"drop-out", EmulatedFaultKind::kDropOut},
    {"nan", EmulatedFaultKind::kNotANumber},     {"spike", EmulatedFaultKind::kSpike},
    {"late", EmulatedFaultKind::kLate},          {"wrong-units", EmulatedFaultKind::kWrongUnits},
    {"force-off", EmulatedFaultKind::kForceOff}, {"refuse", EmulatedFaultKind::kRefuse},
};

}  // namespace

EmulatedHand read_emulated_hand(const TomlTable& device, std::string_view kind) {
  EmulatedHand hand;
  if (kind != "emulated") {
    for (const char* key : {"mass_kg", "grip", "grip_N_per_m", "grip_N_s_per_m", "fault"}) {
      if (device.has(key)) device.fail(key, "is only for kind = \"emulated\"");
    }
    return hand;
  }
  hand.mass = number_in(device, "mass_kg").value_or(hand.mass);
  hand.grip = read_grip(device);
  for (const TomlTable& fault : device.tables("fault")) hand.faults.push_back(read_fault(fault));
  return hand;
}

DeviceDynamics with_emulated_defaults(const DeviceDynamics& given) noexcept {
  DeviceDynamics all = given;
  all.damping = given.damping.value_or(kEmulatedDamping);
  all.friction = given.friction.value_or(kEmulatedFriction);
  all.resolution = given.resolution.value_or(kEmulatedResolution);
  return all;
}

std::span<const EmulatedFaultName> emulated_fault_names() noexcept { return kFaultNames; }

std::string_view name_of(EmulatedFaultKind kind) noexcept {
  for (const EmulatedFaultName& known : kFaultNames) {
    if (known.kind == kind) return known.name;
  }
  return "";
}

std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept {
  for (const EmulatedFaultName& known : kFaultNames) {
    if (known.name == name) return known.kind;
  }
  return std::nullopt;
}

}  // namespace palpate::scene
