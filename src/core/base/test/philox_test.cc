#include "core/base/philox.h"

#include <bit>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Known answers of Random123 (kat_vectors, philox4x32 10).
TEST(Philox, ZeroCounterAndKeyGiveTheKnownAnswer) {
  constexpr PhiloxCounter kWant{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8};
  static_assert(philox4x32({0, 0, 0, 0}, {0, 0}) == kWant);
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), kWant);
}

TEST(Philox, AllOnesGiveTheKnownAnswer) {
  constexpr std::uint32_t kOnes = 0xffffffff;
  constexpr PhiloxCounter kWant{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd};
  EXPECT_EQ(philox4x32({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}), kWant);
}

TEST(Philox, DigitsOfPiGiveTheKnownAnswer) {
  constexpr PhiloxCounter kWant{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1};
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}), kWant);
}

TEST(Philox, EveryInputBitChangesAboutHalfOfTheOutputBits) {
  const PhiloxCounter base = philox4x32({1, 2, 3, 4}, {5, 6});
  for (std::size_t bit = 0; bit < 192; ++bit) {
    PhiloxCounter counter{1, 2, 3, 4};
    PhiloxKey key{5, 6};
    std::uint32_t& word = bit < 128 ? counter[bit / 32] : key[bit / 32 - 4];
    word ^= 1u << (bit % 32);
    const PhiloxCounter other = philox4x32(counter, key);
    int changed = 0;
    for (std::size_t i = 0; i < 4; ++i) changed += std::popcount(base[i] ^ other[i]);
    EXPECT_GT(changed, 36) << bit;  // 64 expected, standard deviation 5.7
    EXPECT_LT(changed, 92) << bit;
  }
}

}  // namespace
}  // namespace palpate
