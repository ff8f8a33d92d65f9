#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// SIMD vectors by the compiler's vector types. Single precision only excludes candidates; the rest is
// computed in double precision, so no force depends on it. Pictures use single precision. Double precision
// gives the same bits as scalar code.
namespace palpate {

using RawFloat4 = float __attribute__((vector_size(16)));
using RawDouble2 = double __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));

/// Result of a comparison: all bits of a lane are set, or none.
template <typename T>
struct SimdMask {
  using Value = std::conditional_t<sizeof(T) == 4, Int4, Long2>;
  Value v;

  SimdMask() = default;
  SimdMask(Value value) noexcept
      : v(value) {}  // NOLINT(google-explicit-constructor): the result of a comparison
  explicit SimdMask(bool all) noexcept : v(Value{} - (all ? 1 : 0)) {}

  friend SimdMask operator!(const SimdMask& a) noexcept { return {~a.v}; }
  friend SimdMask operator&(const SimdMask& a, const SimdMask& b) noexcept { return {a.v & b.v}; }
  friend SimdMask operator&&(const SimdMask& a, const SimdMask& b) noexcept { return {a.v & b.v}; }
  friend SimdMask operator|(const SimdMask& a, const SimdMask& b) noexcept { return {a.v | b.v}; }

  /// [any] One bit per lane, the first lane in the lowest bit.
  friend std::uint32_t lanes_of(const SimdMask& a) noexcept {
#if defined(__SSE2__)
    if constexpr (sizeof(T) == 4) {
      return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(a.v)));
    } else {
      return static_cast<std::uint32_t>(_mm_movemask_pd(reinterpret_cast<__m128d>(a.v)));
    }
#else
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 16 / sizeof(T); ++i) bits |= (a.v[i] != 0 ? 1U : 0U) << i;
    return bits;
#endif
  }
  friend bool any(const SimdMask& a) noexcept { return lanes_of(a) != 0; }
  friend bool none(const SimdMask& a) noexcept { return lanes_of(a) == 0; }
  friend bool all(const SimdMask& a) noexcept { return lanes_of(!a) == 0; }
};

/// A vector of 16 bytes.
template <typename T>
struct Simd {
  using Value = std::conditional_t<sizeof(T) == 4, RawFloat4, RawDouble2>;
  using Mask = SimdMask<T>;
  static constexpr std::size_t kSize = 16 / sizeof(T);
  Value v;

  Simd() = default;
  explicit Simd(Value value) noexcept : v(value) {}
  explicit Simd(T all) noexcept : v(all - Value{}) {}
  explicit Simd(const std::array<T, kSize>& values) noexcept { std::memcpy(&v, values.data(), sizeof(v)); }

  static Simd load_aligned(const T* from) noexcept { return Simd(*reinterpret_cast<const Value*>(from)); }
  static Simd load_unaligned(const T* from) noexcept {
    Simd loaded;
    std::memcpy(&loaded.v, from, sizeof(v));
    return loaded;
  }
  void store_unaligned(T* to) const noexcept { std::memcpy(to, &v, sizeof(v)); }
  [[nodiscard]] T get(std::size_t lane) const noexcept { return v[lane]; }

  friend Simd operator+(const Simd& a, const Simd& b) noexcept { return Simd(a.v + b.v); }
  friend Simd operator-(const Simd& a, const Simd& b) noexcept { return Simd(a.v - b.v); }
  friend Simd operator*(const Simd& a, const Simd& b) noexcept { return Simd(a.v * b.v); }
  friend Simd operator/(const Simd& a, const Simd& b) noexcept { return Simd(a.v / b.v); }
  friend Simd operator-(const Simd& a) noexcept { return Simd(-a.v); }
  Simd& operator+=(const Simd& b) noexcept { return v += b.v, *this; }
  friend Mask operator<(const Simd& a, const Simd& b) noexcept { return {a.v < b.v}; }
  friend Mask operator>(const Simd& a, const Simd& b) noexcept { return {a.v > b.v}; }
  friend Mask operator<=(const Simd& a, const Simd& b) noexcept { return {a.v <= b.v}; }
  friend Mask operator>=(const Simd& a, const Simd& b) noexcept { return {a.v >= b.v}; }

  friend Simd select(const Mask& mask, const Simd& a, const Simd& b) noexcept {
    return Simd(reinterpret_cast<Value>((mask.v & reinterpret_cast<typename Mask::Value>(a.v)) |
                                        (~mask.v & reinterpret_cast<typename Mask::Value>(b.v))));
  }
  /// [any] The second value where one of them is NaN.
  friend Simd min(const Simd& a, const Simd& b) noexcept { return Simd(a.v < b.v ? a.v : b.v); }
  friend Simd max(const Simd& a, const Simd& b) noexcept { return Simd(a.v > b.v ? a.v : b.v); }
  friend Simd abs(const Simd& a) noexcept {
    return Simd(reinterpret_cast<Value>(reinterpret_cast<typename Mask::Value>(a.v) &
                                        ~reinterpret_cast<typename Mask::Value>(-Value{})));
  }
  friend Simd sqrt(const Simd& a) noexcept {
#if defined(__SSE2__)
    if constexpr (sizeof(T) == 4) {
      return Simd(reinterpret_cast<Value>(_mm_sqrt_ps(a.v)));
    } else {
      return Simd(reinterpret_cast<Value>(_mm_sqrt_pd(a.v)));
    }
#else
    Simd root;
    for (std::size_t i = 0; i < kSize; ++i) root.v[i] = std::sqrt(a.v[i]);
    return root;
#endif
  }
};

using Float4 = Simd<float>;
using Float4Mask = Float4::Mask;
inline constexpr std::size_t kLanes = Float4::kSize;

using Double2 = Simd<double>;
using Double2Mask = Double2::Mask;
inline constexpr std::size_t kDoubles = Double2::kSize;

/// [any]
[[nodiscard]] inline Double2 pair_of(double first, double second) noexcept {
  return Double2(Double2::Value{first, second});
}

/// [any] The smaller of two numbers.
[[nodiscard]] inline double least_of(const Double2& pair) noexcept {
  return pair.get(0) < pair.get(1) ? pair.get(0) : pair.get(1);
}

/// [any] The larger of two numbers.
[[nodiscard]] inline double largest_of(const Double2& pair) noexcept {
  return pair.get(0) < pair.get(1) ? pair.get(1) : pair.get(0);
}

/// [any] The largest of the lanes.
[[nodiscard]] inline float largest_of(const Float4& lanes) noexcept {
  const float a = lanes.get(0) > lanes.get(1) ? lanes.get(0) : lanes.get(1);
  const float b = lanes.get(2) > lanes.get(3) ? lanes.get(2) : lanes.get(3);
  return a > b ? a : b;
}

/// [any] Row i becomes column i.
inline void transpose(std::array<Float4, kLanes>& rows) noexcept {
  const auto [a, b, c, d] = rows;
  for (std::size_t i = 0; i < kLanes; ++i) rows[i] = Float4(Float4::Value{a.v[i], b.v[i], c.v[i], d.v[i]});
}

}  // namespace palpate
