#include "palpate/histogram.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/base/statistics.h"

namespace palpate::haptics {
namespace {

constexpr std::int64_t kLargest = (std::int64_t{1} << 40) - 1;  // ns, 18 minutes; larger values count as this

}  // namespace

// Bucket of v. Below 2^(kSubBits+1) each value has its own bucket. Above, the `shift` low bits are dropped so
// that kSubBits + 1 leading bits stay; each shift has 2^kSubBits buckets.
void Histogram::add(std::int64_t value_ns) noexcept {
  const std::int64_t value = std::clamp<std::int64_t>(value_ns, 0, kLargest);
  const int width = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(value)));
  const int shift = std::max(0, width - (kSubBits + 1));
  const std::int64_t bucket = (static_cast<std::int64_t>(shift) << kSubBits) + (value >> shift);
  ++counts_[static_cast<std::size_t>(bucket)];
  ++count_;
  max_ = std::max(max_, value);
}

std::int64_t Histogram::percentile(double share) const noexcept {
  if (count_ == 0) return 0;
  const std::uint64_t rank = quantile_index(share, count_) + 1;
  std::uint64_t seen = 0;
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    seen += counts_[static_cast<std::size_t>(bucket)];
    if (seen < rank) continue;
    return std::min(max_, upper_of(bucket));
  }
  return max_;
}

std::vector<Histogram::Bucket> Histogram::buckets() const {
  std::vector<Bucket> filled;
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    const std::uint32_t count = counts_[static_cast<std::size_t>(bucket)];
    if (count > 0) filled.push_back({upper_of(bucket), count});
  }
  return filled;
}

std::int64_t Histogram::upper_of(int bucket) noexcept {
  const int shift = std::max(0, (bucket >> kSubBits) - 1);
  const std::int64_t lead = bucket - (static_cast<std::int64_t>(shift) << kSubBits);
  return ((lead + 1) << shift) - 1;
}

}  // namespace palpate::haptics
