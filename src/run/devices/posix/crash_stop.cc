#include "run/devices/crash_stop.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <mutex>
#include <stdexcept>

#include <unistd.h>

namespace palpate::devices {
namespace {

constexpr std::array<int, 5> kFatal{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};
constexpr std::size_t kMaxEntries = 32;  // open devices
constexpr std::size_t kSignalStackBytes = 1 << 16;

struct CrashEntry {
  std::atomic<CrashStop::Stop> stop{nullptr};
  std::atomic<void*> device{nullptr};
  bool used = false;  // guarded by the mutex
};

// Mutable globals, because a signal handler has no arguments that could carry them.
std::atomic<bool> crashing{false};
std::atomic<pid_t> crashing_thread{0};
std::atomic<pid_t> owner{0};  // the process that opened the devices; a child made by fork() only shares them
std::array<CrashEntry, kMaxEntries> crash_entries;
std::array<struct sigaction, kFatal.size()> actions_before;
std::mutex crash_mutex;        // of set-up, never locked by the handler
std::size_t open_devices = 0;  // entries in use
static_assert(std::atomic<CrashStop::Stop>::is_always_lock_free && std::atomic<void*>::is_always_lock_free);

void rest_ns(long time) noexcept {
  timespec rest{0, time};
  while (nanosleep(&rest, &rest) != 0) continue;
}

/// The handler of a fatal signal. The signal is blocked while it runs; raise() takes effect at its return.
extern "C" void stop_and_die(int number) {
  if (crashing.exchange(true)) {
    while (crashing_thread.load() != gettid())
      rest_ns(CrashStop::kLastWords);  // another thread does the same
    std::signal(number, SIG_DFL);      // a vendor's stop function has crashed
    raise(number);
    return;
  }
  crashing_thread.store(gettid());
  std::signal(SIGALRM, SIG_DFL);
  alarm(1);
  for (const CrashEntry& entry : crash_entries) {
    const CrashStop::Stop stop = entry.stop.load();
    if (stop != nullptr && owner.load() == getpid()) stop(entry.device.load());
  }
  rest_ns(CrashStop::kLastWords);
  for (std::size_t i = 0; i < kFatal.size(); ++i) {
    if (kFatal[i] == number) sigaction(number, &actions_before[i], nullptr);
  }
  raise(number);
}

void install_handlers() {
  struct sigaction action {};
  action.sa_handler = stop_and_die;
  action.sa_flags = SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  owner.store(getpid());
  for (std::size_t i = 0; i < kFatal.size(); ++i) sigaction(kFatal[i], &action, &actions_before[i]);
}

void restore_handlers() {
  for (std::size_t i = 0; i < kFatal.size(); ++i) {
    struct sigaction now {};
    sigaction(kFatal[i], nullptr, &now);
    if (now.sa_handler == stop_and_die) sigaction(kFatal[i], &actions_before[i], nullptr);
  }
}

}  // namespace

bool is_crashing() noexcept { return crashing.load(std::memory_order_relaxed); }

CrashStop::CrashStop(Stop stop, void* device) : entry_(0) {
  const std::lock_guard lock(crash_mutex);
  while (entry_ < kMaxEntries && crash_entries[entry_].used) ++entry_;
  if (entry_ == kMaxEntries) throw std::length_error("CrashStop: too many devices are open");
  CrashEntry& entry = crash_entries[entry_];
  entry.used = true;
  entry.device.store(device);
  entry.stop.store(stop);
  if (open_devices++ == 0) install_handlers();
}

CrashStop::~CrashStop() {
  const std::lock_guard lock(crash_mutex);
  crash_entries[entry_].stop.store(nullptr);
  crash_entries[entry_].used = false;
  if (--open_devices == 0) restore_handlers();
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
