#include "run/devices/crash_stop.h"

#include <array>
#include <atomic>
#include <mutex>
#include <stdexcept>

namespace palpate::devices {
namespace {

constexpr std::size_t kMaxEntries = 32;  // open devices

struct CrashEntry {
  std::atomic<CrashStop::Stop> stop{nullptr};
  std::atomic<void*> device{nullptr};
  bool used = false;  // guarded by the mutex
};

// Mutable globals, because a handler has no arguments that could carry them.
std::atomic<bool> crashing{false};
std::array<CrashEntry, kMaxEntries> crash_entries;
std::mutex crash_mutex;        // of set-up, never locked by the handler
std::size_t open_devices = 0;  // entries in use
static_assert(std::atomic<CrashStop::Stop>::is_always_lock_free && std::atomic<void*>::is_always_lock_free);

}  // namespace

bool is_crashing() noexcept { return crashing.load(std::memory_order_relaxed); }

bool begin_crash() noexcept { return crashing.exchange(true); }

void stop_devices() noexcept {
  for (const CrashEntry& entry : crash_entries) {
    const CrashStop::Stop stop = entry.stop.load();
    if (stop != nullptr) stop(entry.device.load());
  }
}

CrashStop::CrashStop(Stop stop, void* device) : entry_(0) {
  const std::lock_guard lock(crash_mutex);
  while (entry_ < kMaxEntries && crash_entries[entry_].used) ++entry_;
  if (entry_ == kMaxEntries) throw std::length_error("CrashStop: too many devices are open");
  CrashEntry& entry = crash_entries[entry_];
  entry.used = true;
  entry.device.store(device);
  entry.stop.store(stop);
  if (open_devices++ == 0) install_crash_handlers();
}

CrashStop::~CrashStop() {
  const std::lock_guard lock(crash_mutex);
  crash_entries[entry_].stop.store(nullptr);
  crash_entries[entry_].used = false;
  if (--open_devices == 0) restore_crash_handlers();
}

}  // namespace palpate::devices
