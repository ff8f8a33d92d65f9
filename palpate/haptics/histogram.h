#pragma once
#include <array>
#include <cstdint>

namespace palpate::haptics {

/// Counts of non-negative times [ns] in buckets of about 0.1 to 0.2 % width (three digits) up to 2^40 ns; no
/// allocation after construction.
class Histogram final {
 public:
  /// [rt] Adds one value (negative counts as 0).
  void add(std::int64_t value_ns) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::int64_t max() const noexcept { return max_; }
  /// [any] The smallest value that at least `share` (0..1) of all values do not exceed, to three digits; 0
  /// when empty.
  [[nodiscard]] std::int64_t percentile(double share) const noexcept;

 private:
  static constexpr int kSubBits = 10;
  static constexpr int kBuckets = (41 - kSubBits) << kSubBits;
  std::array<std::uint32_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace palpate::haptics
