#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace palpate {

/// [setup] Calls body(begin, end) for every range of `grain` indices of 0 .. count-1 (the last may be
/// shorter), on all processors, in any order; returns when all are done. The ranges depend on `count` and
/// `grain` alone, so whatever one call works out by itself is the same bits on any number of processors. The
/// calling thread takes part. An exception of the body comes out here, after the other ranges were given up.
/// `grain` 0 is 1.
void for_ranges(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t begin, std::size_t end)>& body);

/// While this lives, for_ranges() keeps its worker threads; its end waits until they are gone (unless another
/// thread still uses them), so that none wakes up beside a loop in real time.
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
