#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// SIMD vectors by the compiler's vector types. Single precision only excludes candidates; the rest is
// computed in double precision, so no force depends on it. Pictures use single precision.
namespace palpate {

using RawFloat4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Result of a comparison: all bits of a lane are set, or none.
struct Float4Mask {
  using Value = Int4;
  Value v;

  Float4Mask() = default;
  Float4Mask(Value value) noexcept
      : v(value) {}  // NOLINT(google-explicit-constructor): the result of a comparison
  explicit Float4Mask(bool all) noexcept : v(Value{} - (all ? 1 : 0)) {}

  friend Float4Mask operator!(const Float4Mask& a) noexcept { return {~a.v}; }
  friend Float4Mask operator&(const Float4Mask& a, const Float4Mask& b) noexcept { return {a.v & b.v}; }
  friend Float4Mask operator&&(const Float4Mask& a, const Float4Mask& b) noexcept { return {a.v & b.v}; }
  friend Float4Mask operator|(const Float4Mask& a, const Float4Mask& b) noexcept { return {a.v | b.v}; }

  /// [any] One bit per lane, the first lane in the lowest bit.
  friend std::uint32_t lanes_of(const Float4Mask& a) noexcept {
#if defined(__SSE2__)
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(a.v)));
#else
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits |= (a.v[i] != 0 ? 1U : 0U) << i;
    return bits;
#endif
  }
  friend bool any(const Float4Mask& a) noexcept { return lanes_of(a) != 0; }
  friend bool none(const Float4Mask& a) noexcept { return lanes_of(a) == 0; }
  friend bool all(const Float4Mask& a) noexcept { return lanes_of(!a) == 0; }
};

/// Four single-precision numbers.
struct Float4 {
  using Value = RawFloat4;
  using Mask = Float4Mask;
  static constexpr std::size_t kSize = 4;
  Value v;

  Float4() = default;
  explicit Float4(Value value) noexcept : v(value) {}
  explicit Float4(float all) noexcept : v(all - Value{}) {}
  explicit Float4(const std::array<float, kSize>& values) noexcept {
    std::memcpy(&v, values.data(), sizeof(v));
  }

  static Float4 load_aligned(const float* from) noexcept {
    return Float4(*reinterpret_cast<const Value*>(from));
  }
  static Float4 load_unaligned(const float* from) noexcept {
    Float4 loaded;
    std::memcpy(&loaded.v, from, sizeof(v));
    return loaded;
  }
  /// [any] Four integers as numbers.
  static Float4 converted(const std::int16_t* from) noexcept {
    // Each integer twice, then shifted down as one of 32 bits: g++ 12 would convert four of 16 bits one by
    // one.
    using Eight = std::int16_t __attribute__((vector_size(16)));
    using Two = std::int64_t __attribute__((vector_size(16)));
    std::int64_t four = 0;
    std::memcpy(&four, from, sizeof(four));
    const auto all = reinterpret_cast<Eight>(Two{four, 0});
    const auto twice = reinterpret_cast<Int4>(__builtin_shufflevector(all, all, 0, 0, 1, 1, 2, 2, 3, 3));
    return Float4(__builtin_convertvector(twice >> 16, Value));
  }
  void store_unaligned(float* to) const noexcept { std::memcpy(to, &v, sizeof(v)); }
  [[nodiscard]] float get(std::size_t lane) const noexcept { return v[lane]; }

  friend Float4 operator+(const Float4& a, const Float4& b) noexcept { return Float4(a.v + b.v); }
  friend Float4 operator-(const Float4& a, const Float4& b) noexcept { return Float4(a.v - b.v); }
  friend Float4 operator*(const Float4& a, const Float4& b) noexcept { return Float4(a.v * b.v); }
  friend Float4 operator/(const Float4& a, const Float4& b) noexcept { return Float4(a.v / b.v); }
  friend Float4 operator-(const Float4& a) noexcept { return Float4(-a.v); }
  Float4& operator+=(const Float4& b) noexcept { return v += b.v, *this; }
  friend Mask operator<(const Float4& a, const Float4& b) noexcept { return {a.v < b.v}; }
  friend Mask operator>(const Float4& a, const Float4& b) noexcept { return {a.v > b.v}; }
  friend Mask operator<=(const Float4& a, const Float4& b) noexcept { return {a.v <= b.v}; }
  friend Mask operator>=(const Float4& a, const Float4& b) noexcept { return {a.v >= b.v}; }

  friend Float4 select(const Mask& mask, const Float4& a, const Float4& b) noexcept {
    return Float4(reinterpret_cast<Value>((mask.v & reinterpret_cast<Mask::Value>(a.v)) |
                                          (~mask.v & reinterpret_cast<Mask::Value>(b.v))));
  }
  /// [any] The second value where one of them is NaN.
  friend Float4 min(const Float4& a, const Float4& b) noexcept { return Float4(a.v < b.v ? a.v : b.v); }
  friend Float4 max(const Float4& a, const Float4& b) noexcept { return Float4(a.v > b.v ? a.v : b.v); }
  friend Float4 abs(const Float4& a) noexcept {
    return Float4(reinterpret_cast<Value>(reinterpret_cast<Mask::Value>(a.v) &
                                          ~reinterpret_cast<Mask::Value>(-Value{})));
  }
  friend Float4 sqrt(const Float4& a) noexcept {
#if defined(__SSE2__)
    return Float4(_mm_sqrt_ps(a.v));
#else
    Float4 root;
    for (std::size_t i = 0; i < kSize; ++i) root.v[i] = std::sqrt(a.v[i]);
    return root;
#endif
  }
};

inline constexpr std::size_t kLanes = Float4::kSize;

/// [any] Row i becomes column i.
inline void transpose(std::array<Float4, kLanes>& rows) noexcept {
  const auto [a, b, c, d] = rows;
  const RawFloat4 ab_low = __builtin_shufflevector(a.v, b.v, 0, 4, 1, 5);
  const RawFloat4 ab_high = __builtin_shufflevector(a.v, b.v, 2, 6, 3, 7);
  const RawFloat4 cd_low = __builtin_shufflevector(c.v, d.v, 0, 4, 1, 5);
  const RawFloat4 cd_high = __builtin_shufflevector(c.v, d.v, 2, 6, 3, 7);
  rows[0] = Float4(__builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5));
  rows[1] = Float4(__builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7));
  rows[2] = Float4(__builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5));
  rows[3] = Float4(__builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7));
}

}  // namespace palpate
