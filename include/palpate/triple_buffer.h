#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace palpate {

/// Passes the newest value of T from one writer thread to one reader thread; neither ever waits. The writer
/// owns one slot, the reader owns one, and both exchange theirs for the third. The reader never sees a partly
/// written value.
template <typename T>
class TripleBuffer final {
 public:
  /// [rt] The writer's slot. Fill it, then call publish().
  [[nodiscard]] T& writable() noexcept { return slots_[write_]; }

  /// [rt] Makes the writer's slot the newest value.
  void publish() noexcept { write_ = shared_.exchange(write_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  /// [rt] Takes the newest value if one was published since the last call. @return whether a value was taken.
  bool refresh() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    read_ = shared_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

  /// [rt] The value that the last refresh() took; default-constructed before the first.
  [[nodiscard]] const T& value() const noexcept { return slots_[read_]; }

 private:
  static constexpr std::uint32_t kFresh = 4;
  static constexpr std::uint32_t kIndex = 3;

  std::array<T, 3> slots_{};
  alignas(64) std::atomic<std::uint32_t> shared_{2};
  alignas(64) std::uint32_t write_ = 0;
  alignas(64) std::uint32_t read_ = 1;
};

}  // namespace palpate
