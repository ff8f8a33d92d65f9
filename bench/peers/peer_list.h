#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "bench/peers/plugin.h"

// One function per peer, each in its own file; only the peers found are compiled.
namespace palpate::bench::peers {

[[nodiscard]] PalpatePeer bullet();
[[nodiscard]] PalpatePeer embree();
[[nodiscard]] PalpatePeer fcl();

}  // namespace palpate::bench::peers
