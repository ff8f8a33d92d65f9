// Serial version of for_ranges(), for builds without threads.
#include <algorithm>
#include <cstddef>
#include <functional>

#include "core/base/parallel.h"

namespace palpate {

struct WorkerThreads::Handle {};
WorkerThreads::WorkerThreads() = default;
WorkerThreads::~WorkerThreads() = default;

struct ThreadLimit::Handle {};
ThreadLimit::ThreadLimit(std::size_t /*most*/) {}
ThreadLimit::~ThreadLimit() = default;

void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  for (std::size_t begin = 0; begin < count; begin += grain) body(begin, std::min(begin + grain, count));
}

}  // namespace palpate
