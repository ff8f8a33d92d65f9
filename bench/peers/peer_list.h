#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "bench/peers/plugin.h"

// One function a peer, each in a file of its own; only those that were found are compiled.
namespace palpate::bench::peers {

[[nodiscard]] PalpatePeer bullet();
[[nodiscard]] PalpatePeer embree();
[[nodiscard]] PalpatePeer fcl();

}  // namespace palpate::bench::peers
