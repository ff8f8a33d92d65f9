#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::haptics {

/// Histogram of non-negative times [ns] up to 2^40 ns (18 minutes); longer times count as 2^40 ns. A bucket
/// is at most 0.1 % wide, so a percentile is correct to three digits. It allocates no memory.
class Histogram final {
 public:
  /// [rt] Adds one value [ns]; a negative value counts as 0.
  void add(std::int64_t value_ns) noexcept;
  /// [any] Number of values.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// [any] The largest value [ns], exact; 0 when empty.
  [[nodiscard]] std::int64_t max() const noexcept { return max_; }
  /// [any] Percentile [ns]: at least the fraction `share` (0..1) of all values is not larger. Rounded up by
  /// at most 0.1 %; 0 when empty.
  [[nodiscard]] std::int64_t percentile(double share) const noexcept;

  struct Bucket {
    std::int64_t upper = 0;  // ns, largest value of the bucket
    std::uint64_t count = 0;
  };
  /// [setup] Buckets that are not empty, in ascending order.
  [[nodiscard]] std::vector<Bucket> buckets() const;

 private:
  /// Largest value [ns] of a bucket.
  [[nodiscard]] static std::int64_t upper_of(int bucket) noexcept;

  static constexpr int kSubBits = 10;  // 2^10 buckets per factor of two
  static constexpr int kBuckets = (41 - kSubBits) << kSubBits;
  std::array<std::uint32_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace palpate::haptics
