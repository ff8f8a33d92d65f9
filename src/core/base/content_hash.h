#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "palpate/pose.h"

namespace palpate {

/// A type that may be hashed and stored as its bytes: without pointers and without padding (the caller's
/// duty).
template <typename T>
concept PlainElement = std::is_trivially_copyable_v<T> || std::is_same_v<T, Vec3>;

/// A 128-bit hash of contents, equal in every run on every x86-64.
struct ContentHash {
  std::array<std::uint64_t, 2> words{};
  friend bool operator==(const ContentHash&, const ContentHash&) = default;
  /// [setup] 32 hexadecimal digits.
  [[nodiscard]] std::string hexadecimal() const;
};

/// Hashes bytes given in pieces. The length of each piece counts: ("ab", "c") differs from ("a", "bc").
/// Protects against accidental collisions, not against deliberate ones.
class ContentHasher final {
 public:
  /// [any]
  ContentHasher& add(std::span<const std::byte> bytes) noexcept;
  template <PlainElement T>
  ContentHasher& add(std::span<const T> values) noexcept {
    return add(std::as_bytes(values));
  }
  template <PlainElement T>
  ContentHasher& add(const T& value) noexcept {
    return add(std::span<const T>(&value, 1));
  }
  [[nodiscard]] ContentHash hash() const noexcept;

 private:
  void mix(std::uint64_t word) noexcept;

  std::uint64_t a_ = 0x243f6a8885a308d3U;  // first bits of pi's fraction; arbitrary
  std::uint64_t b_ = 0x13198a2e03707344U;
};

}  // namespace palpate
