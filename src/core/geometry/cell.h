#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/charconv.h"
#include "palpate/pose.h"

namespace palpate::geometry {

/// A cube of a regular grid, by its integer coordinates.
using Cell = std::array<std::int64_t, 3>;

/// [any] Hash of three 64-bit numbers.
struct ThreeWordsHash {
  template <typename T>
  std::size_t operator()(const std::array<T, 3>& words) const noexcept {
    std::uint64_t hash = 0;
    for (const T word : words) hash = (hash ^ bit_cast<std::uint64_t>(word)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(hash ^ (hash >> 31));
  }
};

/// [any] The cell of `p` in a grid of cells `width` (> 0) wide. Coordinates beyond 2^62 cells are clamped, so
/// that every cell has neighbours within the integer range.
[[nodiscard]] inline Cell cell_at(const Vec3& p, double width) noexcept {
  constexpr double kOutermost = 0x1p62;
  Cell cell{};
  for (int k = 0; k < 3; ++k) {
    const double at = std::floor(p[k] / width);
    const double held = at < kOutermost ? at : kOutermost;
    cell[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(held > -kOutermost ? held : -kOutermost);
  }
  return cell;
}

}  // namespace palpate::geometry
