#pragma once
// Loops over independent hands or environments on several threads.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>

#include "core/base/parallel.h"

#include "bindings/c/float_environment.h"

namespace palpate::python {

/// [setup] Number of threads for `count` items: `jobs`, or the cores that this program may use; at most one
/// per item. @throws InputError for no or too many jobs
[[nodiscard]] std::size_t threads_for(std::optional<std::size_t> jobs, std::size_t count);

/// [setup] Calls act(thread, item) for all items, on all of `threads` at once. Threads take blocks of items
/// in turn, so that one that is slowed down takes fewer. @param act must be independent of the thread's
/// number, which is for buffers
template <typename Act>
void on_threads(std::size_t threads, std::size_t count, const Act& act) {
  constexpr std::size_t kBlocksPerThread = 8;
  const std::size_t block = std::max<std::size_t>(count / (threads * kBlocksPerThread), 1);
  std::atomic<std::size_t> next{0};
  for_ranges(threads, 1, [&](std::size_t thread, std::size_t) {
    const c_interface::DefaultFloatEnvironment environment;
    for (;;) {
      const std::size_t first = next.fetch_add(block, std::memory_order_relaxed);
      const std::size_t end = std::min(first + block, count);
      if (first >= end) return;
      for (std::size_t item = first; item < end; ++item) act(thread, item);
    }
  });
}

}  // namespace palpate::python
