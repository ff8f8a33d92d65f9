#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::haptics {

/// Counts of non-negative times [ns] up to 2^40 ns (18 minutes; longer ones count as that) in buckets at most
/// 0.1 % wide, so three digits of a percentile are right; no allocation.
class Histogram final {
 public:
  /// [rt] Adds one value [ns] (negative counts as 0).
  void add(std::int64_t value_ns) noexcept;
  /// [any] How many values were added.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// [any] The largest value [ns], exact; 0 when empty.
  [[nodiscard]] std::int64_t max() const noexcept { return max_; }
  /// [any] The smallest value [ns] that at least `share` (0..1) of all values do not exceed, rounded up by at
  /// most 0.1 %; 0 when empty.
  [[nodiscard]] std::int64_t percentile(double share) const noexcept;

  struct Bucket {
    std::int64_t upper = 0;  // ns, the largest value that falls into it
    std::uint64_t count = 0;
  };
  /// [setup] The buckets that are not empty, ascending.
  [[nodiscard]] std::vector<Bucket> buckets() const;

 private:
  /// The largest value that falls into a bucket.
  [[nodiscard]] static std::int64_t upper_of(int bucket) noexcept;

  static constexpr int kSubBits = 10;  // 2^10 buckets an octave
  static constexpr int kBuckets = (41 - kSubBits) << kSubBits;
  std::array<std::uint32_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace palpate::haptics
