#include "bindings/python/on_threads.h"

#include <fmt/core.h>

#include "palpate/error.h"
#include "run/realtime/realtime.h"

namespace palpate::python {

std::size_t threads_for(std::optional<std::size_t> jobs, std::size_t count) {
  constexpr std::size_t kMaxJobs = 4096;
  if (jobs && (*jobs < 1 || *jobs > kMaxJobs)) {
    throw InputError(fmt::format("jobs = {}: must be 1 to {}", *jobs, kMaxJobs));
  }
  const std::size_t threads = jobs ? *jobs : realtime::usable_cores().size();
  return std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(count, 1));
}

}  // namespace palpate::python
