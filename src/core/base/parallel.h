#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace palpate {

/// [setup] Calls body(begin, end) for every range of `grain` indices of 0 .. count-1 (the last may be
/// shorter), on all processors, in any order. Returns when all are done. The calling thread takes part.
/// Ranges depend on `count` and `grain` only, so the result of one call of `body` has the same bits on any
/// number of processors. An exception of `body` is rethrown here; remaining ranges are then skipped. `grain`
/// 0 counts as 1.
void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Limits the threads of for_ranges() during its lifetime, the calling one included. A smaller limit that
/// lives beside it counts.
class ThreadLimit final {
 public:
  /// [setup] @param most at least 1
  explicit ThreadLimit(std::size_t most);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

/// Keeps the worker threads of for_ranges() during its lifetime. The destructor waits until they have ended
/// (unless another thread still uses them), so that none wakes up beside a real-time loop.
class WorkerThreads final {
 public:
  WorkerThreads();
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace palpate
