#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace palpate {

/// Lock-free queue of fixed capacity from one producer thread to one consumer thread (SPSC queue). Neither
/// waits. Allocates in the constructor only.
template <typename T>
class SpscQueue final {
 public:
  /// [setup] Room for at least `capacity` items (rounded up to a power of two).
  explicit SpscQueue(std::size_t capacity)
      : items_(std::bit_ceil(capacity < 2 ? std::size_t{2} : capacity)) {}

  [[nodiscard]] std::size_t capacity() const noexcept { return items_.size(); }

  /// [rt] Producer: appends a copy. @return false, without any change, when full.
  bool push(const T& item) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == items_.size()) return false;
    items_[head & (items_.size() - 1)] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// [rt] Consumer: removes the oldest item. @return false when empty.
  bool pop(T& item) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    item = items_[tail & (items_.size() - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> items_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace palpate
