#include "palpate/base/parallel.h"

#include <algorithm>
#include <new>

// The thread sanitizer sees nothing inside Debian's TBB and would take its hand-overs for races.
#if defined(__SANITIZE_THREAD__)
#define PALPATE_ONE_THREAD 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PALPATE_ONE_THREAD 1
#endif
#endif

#ifndef PALPATE_ONE_THREAD
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#endif

namespace palpate {

#ifdef PALPATE_ONE_THREAD

struct WorkerThreads::Handle {};
WorkerThreads::WorkerThreads() = default;
WorkerThreads::~WorkerThreads() = default;

void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  for (std::size_t begin = 0; begin < count; begin += grain) body(begin, std::min(begin + grain, count));
}

#else

struct WorkerThreads::Handle {
  tbb::task_scheduler_handle scheduler{tbb::attach{}};
};

WorkerThreads::WorkerThreads() : handle_(std::make_unique<Handle>()) {}

WorkerThreads::~WorkerThreads() { static_cast<void>(tbb::finalize(handle_->scheduler, std::nothrow)); }

void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t ranges = count / grain + (count % grain == 0 ? 0 : 1);
  tbb::parallel_for(
      std::size_t{0}, ranges,
      [&](std::size_t range) { body(range * grain, std::min((range + 1) * grain, count)); },
      tbb::simple_partitioner{});
}

#endif

}  // namespace palpate
