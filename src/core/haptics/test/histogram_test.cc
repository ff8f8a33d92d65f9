#include "palpate/histogram.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

std::int64_t oracle(std::vector<std::int64_t> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

TEST(Histogram, IsZeroWhenEmpty) {
  const Histogram empty;
  EXPECT_EQ(empty.count(), 0u);
  EXPECT_EQ(empty.max(), 0);
  EXPECT_EQ(empty.percentile(0.5), 0);
}

TEST(Histogram, PercentilesAreThoseOfTheSortedValuesWithinOneInAThousand) {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> times(9.0, 3.0);
  Histogram histogram;
  std::vector<std::int64_t> values;
  for (int i = 0; i < 100'000; ++i) {
    values.push_back(static_cast<std::int64_t>(times(random)));
    histogram.add(values.back());
  }
  for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
    const std::int64_t want = oracle(values, share);
    const std::int64_t got = histogram.percentile(share);
    EXPECT_GE(got, want) << share;
    EXPECT_LE(static_cast<double>(got), static_cast<double>(want) * 1.001) << share;
  }
  EXPECT_EQ(histogram.percentile(1.0), histogram.max());
  EXPECT_EQ(histogram.count(), values.size());
}

TEST(Histogram, ValuesBelow2048AreExact) {
  for (std::int64_t value = 0; value < 2048; ++value) {
    Histogram histogram;
    histogram.add(value);
    histogram.add(1'000'000);
    EXPECT_EQ(histogram.percentile(0.5), value);
  }
}

TEST(Histogram, NegativeCountsAsZeroAndTooLargeAsTheLargest) {
  Histogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.percentile(1.0), 0);
  histogram.add(std::int64_t{1} << 60);
  EXPECT_EQ(histogram.max(), (std::int64_t{1} << 40) - 1);
  EXPECT_EQ(histogram.percentile(1.0), (std::int64_t{1} << 40) - 1);
}

TEST(Histogram, ItsBucketsHoldAllValuesWithTheirUpperEdgesAscending) {
  Histogram histogram;
  for (const std::int64_t value : {5, 5, 2047, 2048, 1'000'000}) histogram.add(value);
  const std::vector<Histogram::Bucket> buckets = histogram.buckets();
  ASSERT_EQ(buckets.size(), 4u);
  EXPECT_EQ(buckets[0].upper, 5);  // below 2^11 each value has its own bucket
  EXPECT_EQ(buckets[0].count, 2u);
  EXPECT_EQ(buckets[1].upper, 2047);
  EXPECT_EQ(buckets[2].upper, 2049);  // 2048 and 2049 share a bucket
  EXPECT_GE(buckets[3].upper, 1'000'000);
  EXPECT_LE(buckets[3].upper, 1'001'000);
  EXPECT_TRUE(Histogram().buckets().empty());
}

}  // namespace
}  // namespace palpate::haptics
