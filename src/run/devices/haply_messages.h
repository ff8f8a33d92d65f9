#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "palpate/device.h"

namespace palpate::devices {

/// The key of the vector in a force command: "values" up to service version 3.4, "vector" from 3.5.
enum class HaplyForceField { kValues, kVector };

/// What the service's first message lists.
struct HaplyInventory {
  std::vector<std::string> arms;   // device_id of every Inverse3, in the service's order
  std::vector<std::string> grips;  // device_id of every verse grip, the wireless ones first
  HaplyForceField force_field = HaplyForceField::kValues;
};

/// The state of one arm and its grip in a state message.
struct HaplySample {
  haptics::DeviceState state;  // fault: kNone or kForceOff
  std::string off;             // why its force is off; empty: it is on
};

/// [setup] Reads which devices the service has; unknown fields are ignored.
/// @throws InputError naming the field, its value and the valid values, or the line and column at which the
/// text is not JSON.
[[nodiscard]] HaplyInventory read_haply_inventory(std::string_view text);

/// [any] Reads the state of the arm with that device_id from a state message, and of the grip (empty: none is
/// held, the orientation is the identity and the gripper open). Allocates; not for the tick.
/// @throws InputError as above; also when the arm or the grip is not in the message.
[[nodiscard]] HaplySample read_haply_state(std::string_view text, const std::string& arm,
                                           const std::string& grip);

/// [any] The message that commands a force [N] in the arm's base frame.
[[nodiscard]] std::string haply_force_command(const std::string& arm, const Vec3& force_D,
                                              HaplyForceField field);

}  // namespace palpate::devices
