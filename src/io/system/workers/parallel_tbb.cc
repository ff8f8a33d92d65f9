// Parallel loops on all processors, by TBB.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <new>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include "core/base/parallel.h"

namespace palpate {

struct WorkerThreads::Handle {
  tbb::task_scheduler_handle scheduler{tbb::attach{}};
};

WorkerThreads::WorkerThreads() : handle_(std::make_unique<Handle>()) {}

WorkerThreads::~WorkerThreads() { static_cast<void>(tbb::finalize(handle_->scheduler, std::nothrow)); }

struct ThreadLimit::Handle {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(std::size_t most)
    : handle_(new Handle{{tbb::global_control::max_allowed_parallelism, std::max<std::size_t>(most, 1)}}) {}

ThreadLimit::~ThreadLimit() = default;

void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t ranges = count / grain + (count % grain == 0 ? 0 : 1);
  tbb::parallel_for(
      std::size_t{0}, ranges,
      [&](std::size_t range) { body(range * grain, std::min((range + 1) * grain, count)); },
      tbb::simple_partitioner{});
}

}  // namespace palpate
