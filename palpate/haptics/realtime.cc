#include "palpate/haptics/realtime.h"

#include <cerrno>
#include <cstddef>
#include <system_error>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

namespace palpate::haptics {
namespace {

constexpr int kPriority = 80;  // above interrupt threads (50), below the kernel's own (99)
constexpr std::size_t kTouchedStack = 256UL * 1024UL;  // bytes; a tick uses a few kilobytes
constexpr std::size_t kPage = 4096;

std::string words(int error) { return std::generic_category().message(error); }

}  // namespace

bool ask_for_priority(std::vector<std::string>& remarks) {
  sched_param wanted{};
  wanted.sched_priority = kPriority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) return true;
  remarks.push_back("real-time priority (SCHED_FIFO) was not granted: " + words(error) +
                    "; ticks may begin late (run as root, or allow it with CAP_SYS_NICE or an rtprio limit)");
  return false;
}

[[gnu::noinline]] void touch_stack() noexcept {
  [[maybe_unused]] volatile unsigned char pages[kTouchedStack];
  for (std::size_t i = 0; i < kTouchedStack; i += kPage) pages[i] = 0;
}

MemoryLock::MemoryLock(std::vector<std::string>& remarks)
    : granted_(mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
  if (granted_) return;
  remarks.push_back(
      "memory was not locked (mlockall): " + words(errno) +
      "; a page fault may delay a tick (run as root, or allow it with CAP_IPC_LOCK or a memlock limit)");
}

MemoryLock::~MemoryLock() {
  if (granted_) munlockall();
}

SignalsHeld::SignalsHeld() noexcept {
  sigset_t all;
  sigfillset(&all);
  for (const int own_doing : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGABRT}) {
    sigdelset(&all, own_doing);
  }
  pthread_sigmask(SIG_SETMASK, &all, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

}  // namespace palpate::haptics
