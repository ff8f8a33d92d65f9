#include "bench/measure/times.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::bench {
namespace {

TEST(Times, FiguresOfAThousandAreThoseByHand) {
  std::vector<double> times;
  for (int i = 1000; i >= 1; --i) times.push_back(static_cast<double>(i));
  const TimeStatistics figures = figures_of(times);
  EXPECT_EQ(figures.samples, 1000U);
  EXPECT_EQ(figures.p50_us, 500.0);
  EXPECT_EQ(figures.p99_us, 990.0);
  EXPECT_EQ(figures.p999_us, 999.0);
  EXPECT_EQ(figures.max_us, 1000.0);
}

TEST(Times, FiguresOfNothingAreZero) {
  const TimeStatistics figures = figures_of({});
  EXPECT_EQ(figures.samples, 0U);
  EXPECT_EQ(figures.max_us, 0.0);
}

TEST(Times, EveryCallIsMadeAndCounted) {
  std::uint64_t calls = 0;
  std::uint64_t largest = 0;
  const double cost = median_call_ns([&](std::uint64_t i) {
    ++calls;
    largest = std::max(largest, i);
    return 1.0;
  });
  EXPECT_EQ(calls, 101U * 10'000U);
  EXPECT_EQ(largest, 9'999U);
  EXPECT_GE(cost, 0.0);
}

}  // namespace
}  // namespace palpate::bench
