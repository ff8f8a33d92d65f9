#include "run/devices/crash_stop.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <mutex>
#include <stdexcept>

#include <windows.h>

namespace palpate::devices {
namespace {

constexpr std::size_t kMaxEntries = 32;    // open devices
constexpr ULONG kReservedStack = 1 << 16;  // bytes, for the handler after a stack overflow

struct CrashEntry {
  std::atomic<CrashStop::Stop> stop{nullptr};
  std::atomic<void*> device{nullptr};
  bool used = false;  // guarded by the mutex
};

// Mutable globals, because a handler has no arguments that could carry them.
std::atomic<bool> crashing{false};
std::array<CrashEntry, kMaxEntries> crash_entries;
LPTOP_LEVEL_EXCEPTION_FILTER filter_before = nullptr;
void (*abort_before)(int) = SIG_DFL;
std::mutex crash_mutex;        // of set-up, never locked by the handler
std::size_t open_devices = 0;  // entries in use

/// Stops all devices, once.
void stop_devices() noexcept {
  if (crashing.exchange(true))
    return;  // a vendor's stop function has crashed, or another thread does the same
  for (const CrashEntry& entry : crash_entries) {
    const CrashStop::Stop stop = entry.stop.load();
    if (stop != nullptr) stop(entry.device.load());
  }
  Sleep(static_cast<DWORD>(CrashStop::kLastWords / 1'000'000));
}

LONG WINAPI stop_after_exception(EXCEPTION_POINTERS* exception) {
  stop_devices();
  return filter_before != nullptr ? filter_before(exception) : EXCEPTION_CONTINUE_SEARCH;
}

extern "C" void stop_after_abort(int number) {
  stop_devices();
  std::signal(number, abort_before);
  std::raise(number);
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
  if (open_devices++ > 0) return;
  filter_before = SetUnhandledExceptionFilter(stop_after_exception);
  abort_before = std::signal(SIGABRT, stop_after_abort);
}

CrashStop::~CrashStop() {
  const std::lock_guard lock(crash_mutex);
  crash_entries[entry_].stop.store(nullptr);
  crash_entries[entry_].used = false;
  if (--open_devices > 0) return;
  (void)SetUnhandledExceptionFilter(filter_before);
  std::signal(SIGABRT, abort_before);
}

struct SignalStack::Stack {};

SignalStack::SignalStack() {
  ULONG bytes = kReservedStack;
  (void)SetThreadStackGuarantee(&bytes);
}

SignalStack::~SignalStack() = default;

}  // namespace palpate::devices
