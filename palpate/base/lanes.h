#pragma once
#include <array>
#include <cstdint>

#include <xsimd/xsimd.hpp>

// Four numbers at once, in single precision. In the loop they pass over quickly what cannot count: whatever
// counts is then worked out in double precision, so that no force depends on these. Pictures are drawn from
// them. Two at once in double precision are the same bits as one after the other.
namespace palpate {

/// Four lanes, the baseline of the processor family, so that one program runs everywhere.
using Lanes = xsimd::batch<float, xsimd::sse2>;
using LaneMask = xsimd::batch_bool<float, xsimd::sse2>;
inline constexpr std::size_t kLanes = 4;

/// [any] One bit a lane, the first lowest.
[[nodiscard]] inline std::uint32_t lanes_of(const LaneMask& mask) noexcept {
  return static_cast<std::uint32_t>(_mm_movemask_ps(mask));
}

using Pair = xsimd::batch<double, xsimd::sse2>;
using PairMask = xsimd::batch_bool<double, xsimd::sse2>;
inline constexpr std::size_t kPair = 2;

/// [any]
[[nodiscard]] inline Pair pair_of(double first, double second) noexcept {
  return Pair(_mm_setr_pd(first, second));
}

/// [any] One bit a number, the first lowest.
[[nodiscard]] inline std::uint32_t lanes_of(const PairMask& mask) noexcept {
  return static_cast<std::uint32_t>(_mm_movemask_pd(mask));
}

/// [any] The lesser of two numbers.
[[nodiscard]] inline double least_of(const Pair& pair) noexcept {
  return pair.get(0) < pair.get(1) ? pair.get(0) : pair.get(1);
}

/// [any] The greater of two numbers.
[[nodiscard]] inline double largest_of(const Pair& pair) noexcept {
  return pair.get(0) < pair.get(1) ? pair.get(1) : pair.get(0);
}

/// [any] The largest of the lanes.
[[nodiscard]] inline float largest_of(const Lanes& lanes) noexcept {
  alignas(16) float values[kLanes];
  lanes.store_aligned(values);
  const float a = values[0] > values[1] ? values[0] : values[1];
  const float b = values[2] > values[3] ? values[2] : values[3];
  return a > b ? a : b;
}

/// [any] Row i becomes column i.
inline void transpose(std::array<Lanes, kLanes>& rows) noexcept {
  const __m128 low_01 = _mm_unpacklo_ps(rows[0], rows[1]);
  const __m128 low_23 = _mm_unpacklo_ps(rows[2], rows[3]);
  const __m128 high_01 = _mm_unpackhi_ps(rows[0], rows[1]);
  const __m128 high_23 = _mm_unpackhi_ps(rows[2], rows[3]);
  rows = {Lanes(_mm_movelh_ps(low_01, low_23)), Lanes(_mm_movehl_ps(low_23, low_01)),
          Lanes(_mm_movelh_ps(high_01, high_23)), Lanes(_mm_movehl_ps(high_23, high_01))};
}

}  // namespace palpate
