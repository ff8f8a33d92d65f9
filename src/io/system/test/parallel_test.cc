#include "core/base/parallel.h"

#include <atomic>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Ranges = std::set<std::pair<std::size_t, std::size_t>>;

Ranges ranges_of(std::size_t count, std::size_t grain) {
  Ranges ranges;
  std::mutex mutex;
  for_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(ranges.insert({begin, end}).second);
  });
  return ranges;
}

TEST(ForRanges, AreOfTheGrainAndCoverEveryIndexOnce) {
  EXPECT_EQ(ranges_of(10, 4), (Ranges{{0, 4}, {4, 8}, {8, 10}}));
  EXPECT_EQ(ranges_of(8, 4), (Ranges{{0, 4}, {4, 8}}));
  EXPECT_EQ(ranges_of(3, 100), (Ranges{{0, 3}}));
  EXPECT_EQ(ranges_of(2, 0), (Ranges{{0, 1}, {1, 2}}));
  EXPECT_TRUE(ranges_of(0, 4).empty());
}

TEST(ForRanges, HandOnAnExceptionOfTheBody) {
  EXPECT_THROW(for_ranges(100, 1,
                          [](std::size_t begin, std::size_t) {
                            if (begin == 57) throw std::runtime_error("here");
                          }),
               std::runtime_error);
}

TEST(ForRanges, LeaveNoWorkerBehindWhenTheWorkersEnd) {
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  };
  const auto before = threads();
  for (int again = 0; again < 3; ++again) {
    const WorkerThreads workers;
    std::atomic<std::size_t> sum{0};
    for_ranges(100'000, 10, [&](std::size_t begin, std::size_t end) { sum += end - begin; });
    EXPECT_EQ(sum.load(), 100'000U);
  }
  EXPECT_LE(threads(), before);
}

}  // namespace
}  // namespace palpate
