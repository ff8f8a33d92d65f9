#pragma once
#include <string_view>

#include "palpate/device.h"

namespace palpate::devices {

/// [setup] Limits of a device model. @param name as the device or its library reports it, "omega.7" or
/// "Geomagic Touch X"; the first line of the table (docs/devices.md) whose name it contains counts, in any
/// case of letters. For an unknown model only `model` is set.
[[nodiscard]] haptics::DeviceAbilities abilities_of_model(std::string_view name);

}  // namespace palpate::devices
