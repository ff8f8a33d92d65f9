#include "run/realtime/realtime.h"

#include <cstddef>
#include <system_error>

// The second header needs the first.
// clang-format off
#include <windows.h>
#include <timeapi.h>
// clang-format on

#include "io/system/shared_library.h"

namespace palpate::realtime {
namespace {

constexpr std::size_t kTouchedStack = 256UL * 1024UL;  // bytes; a tick uses about 30 kB
constexpr std::size_t kPage = 4096;
constexpr UINT kTimerPeriod = 1;  // ms, the shortest

std::string describe_last_error() { return std::system_category().message(static_cast<int>(GetLastError())); }

/// Timers as exact as the system has them, and no saving of power by this process, until it ends.
void request_exact_timers() noexcept {
  [[maybe_unused]] static const bool asked = [] {
    (void)timeBeginPeriod(kTimerPeriod);
    PROCESS_POWER_THROTTLING_STATE power{};
    power.Version = PROCESS_POWER_THROTTLING_CURRENT_VERSION;
    constexpr ULONG kIgnoreTimerResolution =
        0x4;  // PROCESS_POWER_THROTTLING_IGNORE_TIMER_RESOLUTION, Windows 11
    power.ControlMask = PROCESS_POWER_THROTTLING_EXECUTION_SPEED | kIgnoreTimerResolution;
    if (SetProcessInformation(GetCurrentProcess(), ProcessPowerThrottling, &power, sizeof power) == 0) {
      power.ControlMask = PROCESS_POWER_THROTTLING_EXECUTION_SPEED;
      (void)SetProcessInformation(GetCurrentProcess(), ProcessPowerThrottling, &power, sizeof power);
    }
    return true;
  }();
}

/// Enters the class "Pro Audio" of the multimedia class scheduler, where that service runs.
void join_pro_audio() {
  static const SharedLibrary library = open_library("avrt.dll", Loading::kForever);
  if (library.handle == nullptr) return;
  using Join = HANDLE(WINAPI*)(LPCWSTR, LPDWORD);
  using Raise = BOOL(WINAPI*)(HANDLE, int);
  const auto join = reinterpret_cast<Join>(find_function(library.handle, "AvSetMmThreadCharacteristicsW"));
  const auto raise = reinterpret_cast<Raise>(find_function(library.handle, "AvSetMmThreadPriority"));
  DWORD task = 0;
  const HANDLE joined = join == nullptr ? nullptr : join(L"Pro Audio", &task);  // until the thread ends
  constexpr int kCritical = 2;                                                  // AVRT_PRIORITY_CRITICAL
  if (joined != nullptr && raise != nullptr) (void)raise(joined, kCritical);
}

}  // namespace

std::optional<std::string> request_priority(Urgency urgency) {
  request_exact_timers();
  if (urgency == Urgency::kLoop) join_pro_audio();
  // The watchdog must run while the loop polls: Windows shares a processor among threads of one priority.
  if (SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL) != 0) return std::nullopt;
  return "real-time priority (time critical) was not granted: " + describe_last_error() +
         "; ticks may begin late (palpate doctor says more)";
}

void yield_to_loop() noexcept { (void)SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_BELOW_NORMAL); }

// Windows does not limit threads of high priority.
std::optional<RealtimeBudget> realtime_budget(const std::filesystem::path& /*root*/) {
  return RealtimeBudget{-1, 1'000'000};
}

std::vector<int> usable_cores() {
  DWORD_PTR process = 0;
  DWORD_PTR system = 0;
  std::vector<int> cores;
  if (GetProcessAffinityMask(GetCurrentProcess(), &process, &system) == 0) return cores;
  for (int core = 0; core < static_cast<int>(8 * sizeof process); ++core) {
    if (((process >> core) & 1U) != 0) cores.push_back(core);
  }
  return cores;
}

bool pin_to_core(int core) noexcept {
  if (core < 0 || core >= static_cast<int>(8 * sizeof(DWORD_PTR))) return false;
  return SetThreadAffinityMask(GetCurrentThread(), DWORD_PTR{1} << core) != 0;
}

[[gnu::noinline]] void prefault_stack() noexcept {
  [[maybe_unused]] volatile unsigned char pages[kTouchedStack];
  for (std::size_t i = kTouchedStack; i >= kPage; i -= kPage)
    pages[i - 1] = 0;  // Windows extends a stack downwards
}

MemoryLock::MemoryLock(std::vector<std::string>& remarks) : granted_(false) {
  remarks.emplace_back(
      "memory was not locked, because Windows locks no whole program; a page fault may delay a tick");
}

MemoryLock::~MemoryLock() = default;

struct BlockedSignals::Before {};

BlockedSignals::BlockedSignals() = default;
BlockedSignals::~BlockedSignals() = default;

}  // namespace palpate::realtime
