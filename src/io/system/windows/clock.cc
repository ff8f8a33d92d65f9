#include "io/system/clock.h"

#include <windows.h>

namespace palpate {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kNanosecondsPerStep = 100;             // of Windows' timers and file times
constexpr std::int64_t kUnixEpoch = 116'444'736'000'000'000;  // steps between 1601 and 1970
// A timer of high resolution ends up to half a millisecond late, so the rest is spent polling the clock.
constexpr std::int64_t kPolled = 600'000;  // ns

std::int64_t ticks_per_second() noexcept {
  static const std::int64_t rate = [] {
    LARGE_INTEGER value{};
    QueryPerformanceFrequency(&value);
    return value.QuadPart;
  }();
  return rate;
}

/// A timer of the calling thread.
class ThreadTimer final {
 public:
  ThreadTimer() noexcept
      : timer_(CreateWaitableTimerExW(nullptr, nullptr, kHighResolution, TIMER_ALL_ACCESS)) {
    if (timer_ == nullptr)
      timer_ = CreateWaitableTimerExW(nullptr, nullptr, 0, TIMER_ALL_ACCESS);  // before Windows 10, 1803
  }
  ~ThreadTimer() {
    if (timer_ != nullptr) CloseHandle(timer_);
  }
  ThreadTimer(const ThreadTimer&) = delete;
  ThreadTimer& operator=(const ThreadTimer&) = delete;

  void sleep(std::int64_t time_ns) noexcept {
    LARGE_INTEGER due{};
    due.QuadPart = -(time_ns / kNanosecondsPerStep);  // negative: from now on
    if (timer_ != nullptr && SetWaitableTimer(timer_, &due, 0, nullptr, nullptr, FALSE) != 0) {
      (void)WaitForSingleObject(timer_, INFINITE);
    } else {
      Sleep(static_cast<DWORD>(time_ns / 1'000'000));
    }
  }

 private:
  static constexpr DWORD kHighResolution = 0x2;  // CREATE_WAITABLE_TIMER_HIGH_RESOLUTION
  HANDLE timer_;
};

}  // namespace

std::int64_t monotonic_ns() noexcept {
  LARGE_INTEGER now{};
  QueryPerformanceCounter(&now);
  const std::int64_t rate = ticks_per_second();
  return now.QuadPart / rate * kNanosecondsPerSecond + now.QuadPart % rate * kNanosecondsPerSecond / rate;
}

// Windows counts a thread's processor time in steps of 15.6 ms, so this is the time that passes.
std::int64_t thread_cpu_ns() noexcept { return monotonic_ns(); }

std::int64_t unix_ns() noexcept {
  FILETIME now{};
  GetSystemTimePreciseAsFileTime(&now);
  const std::int64_t steps = (static_cast<std::int64_t>(now.dwHighDateTime) << 32) | now.dwLowDateTime;
  return (steps - kUnixEpoch) * kNanosecondsPerStep;
}

void sleep_until_ns(std::int64_t deadline) noexcept {
  static thread_local ThreadTimer timer;
  // Only a thread of high priority must wake in time; others would waste a processor.
  const bool urgent = GetThreadPriority(GetCurrentThread()) >= THREAD_PRIORITY_HIGHEST;
  const std::int64_t polled = urgent ? kPolled : 0;
  for (std::int64_t left = deadline - monotonic_ns(); left > polled; left = deadline - monotonic_ns()) {
    timer.sleep(left - polled < kNanosecondsPerStep ? kNanosecondsPerStep : left - polled);
  }
  while (monotonic_ns() < deadline) YieldProcessor();
}

}  // namespace palpate
