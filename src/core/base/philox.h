#pragma once
#include <array>
#include <cstdint>

namespace palpate {

/// Philox 4x32-10: 128 random bits as a pure function of a 128-bit counter and a 64-bit key, so any random
/// number of any run can be computed by itself. [Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers:
/// as easy as 1, 2, 3"]
using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// [rt] The four 32-bit words at `counter` under `key`.
[[nodiscard]] constexpr PhiloxCounter philox4x32(PhiloxCounter counter, PhiloxKey key) noexcept {
  constexpr int kRounds = 10;
  constexpr std::uint64_t kMultiplier0 = 0xd251'1f53;
  constexpr std::uint64_t kMultiplier1 = 0xcd9e'8d57;
  constexpr std::uint32_t kWeyl0 = 0x9e37'79b9;  // golden ratio
  constexpr std::uint32_t kWeyl1 = 0xbb67'ae85;  // sqrt(3) - 1
  auto [c0, c1, c2, c3] = counter;
  auto [k0, k1] = key;
#pragma GCC unroll 10
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t product0 = kMultiplier0 * c0;
    const std::uint64_t product1 = kMultiplier1 * c2;
    c0 = static_cast<std::uint32_t>(product1 >> 32) ^ c1 ^ k0;
    c1 = static_cast<std::uint32_t>(product1);
    c2 = static_cast<std::uint32_t>(product0 >> 32) ^ c3 ^ k1;
    c3 = static_cast<std::uint32_t>(product0);
    k0 += kWeyl0;
    k1 += kWeyl1;
  }
  return {c0, c1, c2, c3};
}

}  // namespace palpate
