#include "run/realtime/realtime.h"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <system_error>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

namespace palpate::realtime {
namespace {

constexpr int kLoopPriority = 80;         // above interrupt threads (50), below the kernel's own (99)
constexpr int kWatchdogPriority = 85;     // it must run while the loop polls
constexpr unsigned long kTimerSlack = 1;  // ns, the smallest; the system's default is 50 us
constexpr std::size_t kTouchedStack = 256UL * 1024UL;  // bytes; a tick uses about 30 kB
constexpr std::size_t kPage = 4096;

std::string describe_error(int error) { return std::generic_category().message(error); }

/// Gives the calling thread the policy `to`, if it has the policy `from`.
void change_policy(int from, int to) noexcept {
  const sched_param normal{};
  if (sched_getscheduler(0) == from) (void)sched_setscheduler(0, to, &normal);  // 0: this thread alone
}

}  // namespace

std::optional<std::string> request_priority(Urgency urgency) {
  (void)prctl(PR_SET_TIMERSLACK, kTimerSlack, 0, 0, 0);
  sched_param wanted{};
  wanted.sched_priority = urgency == Urgency::kLoop ? kLoopPriority : kWatchdogPriority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) return std::nullopt;
  change_policy(SCHED_BATCH, SCHED_OTHER);  // see yield_to_loop()
  return "real-time priority (SCHED_FIFO) was not granted: " + describe_error(error) +
         "; ticks may begin late (palpate doctor says how to grant it)";
}

void yield_to_loop() noexcept { change_policy(SCHED_OTHER, SCHED_BATCH); }

std::optional<RealtimeBudget> realtime_budget(const std::filesystem::path& root) {
  RealtimeBudget budget;
  std::ifstream runtime(root / "proc/sys/kernel/sched_rt_runtime_us");
  std::ifstream period(root / "proc/sys/kernel/sched_rt_period_us");
  const bool read = (runtime >> budget.runtime_us) && (period >> budget.period_us) && budget.period_us > 0;
  return read ? std::optional(budget) : std::nullopt;
}

std::vector<int> usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cores;
  if (sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  }
  return cores;
}

bool pin_to_core(int core) noexcept {
  if (core < 0 || core >= CPU_SETSIZE) return false;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  return pthread_setaffinity_np(pthread_self(), sizeof(set), &set) == 0;
}

[[gnu::noinline]] void prefault_stack() noexcept {
  [[maybe_unused]] volatile unsigned char pages[kTouchedStack];
  for (std::size_t i = 0; i < kTouchedStack; i += kPage) pages[i] = 0;
}

MemoryLock::MemoryLock(std::vector<std::string>& remarks)
    : granted_(mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
  if (granted_) return;
  remarks.push_back("memory was not locked (mlockall): " + describe_error(errno) +
                    "; a page fault may delay a tick (palpate doctor says how to grant it)");
}

MemoryLock::~MemoryLock() {
  if (granted_) munlockall();
}

struct BlockedSignals::Before {
  sigset_t signals;
};

BlockedSignals::BlockedSignals() : before_(std::make_unique<Before>()) {
  sigset_t all;
  sigfillset(&all);
  for (const int own_doing : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGABRT}) {
    sigdelset(&all, own_doing);
  }
  pthread_sigmask(SIG_SETMASK, &all, &before_->signals);
}

BlockedSignals::~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_->signals, nullptr); }

}  // namespace palpate::realtime
