#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// Places in memory that are wanted soon: for work on many things in turn, more than the processor's caches
/// hold. While one is worked on, the next one's memory is on its way.
class FetchList final {
 public:
  /// [setup] Adds the lines of the cache that memory from `begin` to `end` lies in.
  void add(const void* begin, const void* end) {
    const auto* line = static_cast<const std::byte*>(begin);
    line -= reinterpret_cast<std::uintptr_t>(begin) % kLine;
    for (; line < end; line += kLine) lines_.push_back(line);
  }

  /// [setup] Adds all of one object, without what it points to.
  template <typename T>
  void add(const T& object) {
    add(&object, &object + 1);
  }

  /// [setup] Adds the elements of a vector.
  template <typename T>
  void add_elements(const std::vector<T>& values) {
    add(values.data(), values.data() + values.size());
  }

  /// [rt] Lets the processor fetch all of them, and returns at once. Nothing is changed.
  void fetch() const noexcept {
    for (const void* const line : lines_) __builtin_prefetch(line);
  }

  [[nodiscard]] const std::vector<const void*>& lines() const noexcept { return lines_; }

 private:
  static constexpr std::size_t kLine = 64;  // bytes, on every x86-64
  std::vector<const void*> lines_;
};

}  // namespace palpate
