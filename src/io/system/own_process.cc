#include "io/system/own_process.h"

#include <atomic>

#if defined(__linux__)
#include <pthread.h>
#endif

namespace palpate {
namespace {

/// Number of forks between the first OwnProcess and this process. getpid() would be a system call.
std::atomic<std::uint64_t> forks{0};

#if defined(__linux__)
extern "C" void count_fork() { forks.fetch_add(1, std::memory_order_relaxed); }
#endif

}  // namespace

OwnProcess::OwnProcess() : forks_(forks.load(std::memory_order_relaxed)) {
#if defined(__linux__)
  [[maybe_unused]] static const int counts = pthread_atfork(nullptr, nullptr, count_fork);
#endif
}

bool OwnProcess::is_current() const noexcept { return forks.load(std::memory_order_relaxed) == forks_; }

}  // namespace palpate
