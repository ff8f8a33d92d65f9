#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

/// [any] A vertex or triangle number (>= 0) as an index of a standard container.
[[nodiscard]] constexpr std::size_t at(std::int32_t number) noexcept {
  return static_cast<std::size_t>(number);
}

}  // namespace palpate
