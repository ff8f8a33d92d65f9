#pragma once
#include <algorithm>
#include <cstdint>

namespace palpate::geometry {

/// [any] An undirected edge: smaller vertex << 32 | larger vertex.
[[nodiscard]] constexpr std::uint64_t edge_key(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32U | static_cast<std::uint64_t>(std::max(a, b));
}

}  // namespace palpate::geometry
