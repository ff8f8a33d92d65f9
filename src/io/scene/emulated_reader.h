#pragma once
#include <string_view>

#include "io/scene/toml_reader.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] Reads mass, grip and faults from [device]; missing keys keep their defaults. @param kind the
/// device's kind @throws InputError as TomlTable; also for any of these keys when the kind is not "emulated".
[[nodiscard]] EmulatedHand read_emulated_hand(const TomlTable& device, std::string_view kind);

/// [setup] `given`, with the emulated hand's defaults for all values that it lacks.
[[nodiscard]] DeviceDynamics with_emulated_defaults(const DeviceDynamics& given) noexcept;

}  // namespace palpate::scene
