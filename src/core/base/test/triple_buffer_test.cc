#include "palpate/triple_buffer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(TripleBuffer, HasNothingNewBeforeTheFirstPublish) {
  TripleBuffer<int> cell;
  EXPECT_FALSE(cell.refresh());
  EXPECT_EQ(cell.value(), 0);
}

TEST(TripleBuffer, GivesTheNewestAndEachOnce) {
  TripleBuffer<int> cell;
  for (int i = 1; i <= 5; ++i) {
    cell.writable() = i;
    cell.publish();
  }
  EXPECT_TRUE(cell.refresh());
  EXPECT_EQ(cell.value(), 5);
  EXPECT_FALSE(cell.refresh());
  EXPECT_EQ(cell.value(), 5);
}

TEST(TripleBuffer, KeepsTheReadersValueWhileTheWriterGoesOn) {
  TripleBuffer<int> cell;
  cell.writable() = 1;
  cell.publish();
  ASSERT_TRUE(cell.refresh());
  for (int i = 2; i < 10; ++i) {
    cell.writable() = i;
    cell.publish();
    EXPECT_EQ(cell.value(), 1);
  }
}

TEST(TripleBuffer, IsNeverTornAndNeverGoesBackBetweenTwoThreads) {
  using Block = std::array<std::uint64_t, 64>;
  constexpr std::uint64_t kLast = 100'000;
  TripleBuffer<Block> cell;
  std::thread writer([&cell] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      cell.writable().fill(i);
      cell.publish();
    }
  });
  std::uint64_t previous = 0;
  int torn = 0;
  int backward = 0;
  while (previous < kLast) {
    if (!cell.refresh()) {
      std::this_thread::yield();
      continue;
    }
    const Block& block = cell.value();
    if (std::any_of(block.begin(), block.end(), [&block](std::uint64_t word) { return word != block[0]; }))
      ++torn;
    if (block[0] <= previous) ++backward;
    previous = block[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backward, 0);
}

}  // namespace
}  // namespace palpate
