#include "run/devices/crash_stop.h"

#include <array>
#include <atomic>
#include <csignal>
#include <ctime>

#include <unistd.h>

namespace palpate::devices {
namespace {

constexpr std::array<int, 5> kFatal{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};
constexpr std::size_t kSignalStackBytes = 1 << 16;

// Mutable globals, because a signal handler has no arguments that could carry them.
std::atomic<pid_t> crashing_thread{0};
std::atomic<pid_t> owner{0};  // the process that opened the devices; a child made by fork() only shares them
std::array<struct sigaction, kFatal.size()> actions_before;

void rest_ns(long time) noexcept {
  timespec rest{0, time};
  while (nanosleep(&rest, &rest) != 0) continue;
}

/// The handler of a fatal signal. The signal is blocked while it runs; raise() takes effect at its return.
extern "C" void stop_and_die(int number) {
  if (begin_crash()) {
    while (crashing_thread.load() != gettid())
      rest_ns(CrashStop::kLastWords);  // another thread does the same
    std::signal(number, SIG_DFL);      // a vendor's stop function has crashed
    raise(number);
    return;
  }
  crashing_thread.store(gettid());
  std::signal(SIGALRM, SIG_DFL);
  alarm(1);
  if (owner.load() == getpid()) stop_devices();
  rest_ns(CrashStop::kLastWords);
  for (std::size_t i = 0; i < kFatal.size(); ++i) {
    if (kFatal[i] == number) sigaction(number, &actions_before[i], nullptr);
  }
  raise(number);
}

}  // namespace

void install_crash_handlers() {
  struct sigaction action {};
  action.sa_handler = stop_and_die;
  action.sa_flags = SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  owner.store(getpid());
  for (std::size_t i = 0; i < kFatal.size(); ++i) sigaction(kFatal[i], &action, &actions_before[i]);
}

void restore_crash_handlers() {
  for (std::size_t i = 0; i < kFatal.size(); ++i) {
    struct sigaction now {};
    sigaction(kFatal[i], nullptr, &now);
    if (now.sa_handler == stop_and_die) sigaction(kFatal[i], &actions_before[i], nullptr);
  }
}

struct SignalStack::Stack {
  std::array<char, kSignalStackBytes> bytes;
  stack_t before;
};

SignalStack::SignalStack() : stack_(std::make_unique<Stack>()) {
  stack_t own{};
  own.ss_sp = stack_->bytes.data();
  own.ss_size = stack_->bytes.size();
  sigaltstack(&own, &stack_->before);
}

SignalStack::~SignalStack() { sigaltstack(&stack_->before, nullptr); }

}  // namespace palpate::devices
