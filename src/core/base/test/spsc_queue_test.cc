#include "core/base/spsc_queue.h"

#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(SpscQueue, HasRoomForAtLeastWhatWasAskedFor) {
  EXPECT_EQ(SpscQueue<int>(0).capacity(), 2u);
  EXPECT_EQ(SpscQueue<int>(1).capacity(), 2u);
  EXPECT_EQ(SpscQueue<int>(5).capacity(), 8u);
  EXPECT_EQ(SpscQueue<int>(8).capacity(), 8u);
}

TEST(SpscQueue, GivesBackInOrder) {
  SpscQueue<int> ring(4);
  int item = 0;
  EXPECT_FALSE(ring.pop(item));
  for (int round = 0; round < 10; ++round) {  // wraps round
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(ring.push(10 * round + i));
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(ring.pop(item));
      EXPECT_EQ(item, 10 * round + i);
    }
    EXPECT_FALSE(ring.pop(item));
  }
}

TEST(SpscQueue, RefusesWhenFullAndKeepsWhatItHas) {
  SpscQueue<int> ring(2);
  EXPECT_TRUE(ring.push(1));
  EXPECT_TRUE(ring.push(2));
  EXPECT_FALSE(ring.push(3));
  int item = 0;
  EXPECT_TRUE(ring.pop(item));
  EXPECT_EQ(item, 1);
  EXPECT_TRUE(ring.push(4));
  EXPECT_TRUE(ring.pop(item));
  EXPECT_EQ(item, 2);
  EXPECT_TRUE(ring.pop(item));
  EXPECT_EQ(item, 4);
}

TEST(SpscQueue, LosesAndTearsNothingBetweenTwoThreads) {
  struct Pair {
    std::uint64_t number = 0;
    std::uint64_t complement = 0;
  };
  constexpr std::uint64_t kItems = 200'000;
  SpscQueue<Pair> ring(64);
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kItems; ++i) {
      while (!ring.push({i, ~i})) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kItems; ++i) {
    Pair item;
    while (!ring.pop(item)) std::this_thread::yield();
    if (item.number != i || item.complement != ~i) ++wrong;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace palpate
