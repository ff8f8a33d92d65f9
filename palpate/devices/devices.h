#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/haptics/device.h"
#include "palpate/scene/setup.h"

namespace palpate::devices {

/// [setup] Opens the device of one hand: "scripted" (with or without a path), "replay" (a recording; its
/// samples of that hand) or "haply" (hands with one address take its arms in order). Reads its files and
/// connects now. @throws InputError naming the kind, the file or address and what is wrong (a replayed
/// recording's rate must be the scene's).
[[nodiscard]] std::unique_ptr<haptics::Device> open_device(const scene::Setup& setup, std::size_t hand);

}  // namespace palpate::devices
