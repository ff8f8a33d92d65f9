// Parallel loops on all processors, by threads that each call starts.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/parallel.h"

namespace palpate {
namespace {

std::mutex limits_mutex;
std::multiset<std::size_t> limits;  // of all ThreadLimits that exist

thread_local bool is_in_range = false;  // a loop within a loop runs serially

std::size_t threads_for(std::size_t ranges) {
  if (is_in_range) return 1;
  std::size_t most = std::max<std::size_t>(1, std::thread::hardware_concurrency());
  const std::lock_guard lock(limits_mutex);
  if (!limits.empty()) most = std::min(most, *limits.begin());
  return std::min(most, ranges);
}

}  // namespace

struct WorkerThreads::Handle {};
WorkerThreads::WorkerThreads() = default;
WorkerThreads::~WorkerThreads() = default;

struct ThreadLimit::Handle {
  std::size_t most;
};

ThreadLimit::ThreadLimit(std::size_t most) : handle_(new Handle{std::max<std::size_t>(most, 1)}) {
  const std::lock_guard lock(limits_mutex);
  limits.insert(handle_->most);
}

ThreadLimit::~ThreadLimit() {
  const std::lock_guard lock(limits_mutex);
  limits.erase(limits.find(handle_->most));
}

void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t ranges = count / grain + (count % grain == 0 ? 0 : 1);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    const bool was_in_range = std::exchange(is_in_range, true);
    for (std::size_t range = next++; range < ranges; range = next++) {
      try {
        body(range * grain, std::min((range + 1) * grain, count));
      } catch (...) {
        next.store(ranges);
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    }
    is_in_range = was_in_range;
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < threads_for(ranges); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
