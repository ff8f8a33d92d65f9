#pragma once
#include <string_view>

#include "io/scene/toml_reader.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] Mass, grip and faults of [device]; what is left out keeps its default. @param kind the device's
/// @throws InputError as TomlTable; also for any of those keys when the kind is not "emulated".
[[nodiscard]] EmulatedHand read_emulated_hand(const TomlTable& device, std::string_view kind);

/// [setup] `given`, with the emulated hand's defaults where it says nothing.
[[nodiscard]] DeviceDynamics with_emulated_defaults(const DeviceDynamics& given) noexcept;

}  // namespace palpate::scene
