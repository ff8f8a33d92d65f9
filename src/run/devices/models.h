#pragma once
#include <string_view>

#include "palpate/device.h"

namespace palpate::devices {

/// [setup] What the devices of a model bear, by the name that the device or its library gives, "omega.7" or
/// "Geomagic Touch X": that of the first line of the table (docs/devices.md) whose name is a part of it,
/// whatever the case. Of an unknown model only `model` is set.
[[nodiscard]] haptics::DeviceAbilities abilities_of_model(std::string_view name);

}  // namespace palpate::devices
