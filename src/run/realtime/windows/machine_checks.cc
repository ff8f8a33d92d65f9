#include "run/realtime/machine_checks.h"

#include <system_error>
#include <thread>

// The second header needs the first.
// clang-format off
#include <windows.h>
#include <powrprof.h>
// clang-format on

#include "io/system/files.h"
#include "run/realtime/realtime.h"

namespace palpate::realtime {
namespace {

MachineCheck system_check() {
  MachineCheck check{"system", Verdict::kGood, "Windows", {}};
  if (!is_wine()) return check;
  check.verdict = Verdict::kUnknown;
  check.found = "Wine, which runs Windows programs on another system";
  check.advice = "the figures here are Wine's; measure on Windows itself";
  return check;
}

MachineCheck priority_check() {
  MachineCheck check{"real-time priority", Verdict::kGood, {}, {}};
  std::optional<std::string> refusal;
  std::thread([&refusal] { refusal = request_priority(Urgency::kLoop); }).join();
  check.found = refusal ? *refusal : "time critical, and the class Pro Audio where its service (MMCSS) runs";
  if (!refusal) return check;
  check.verdict = Verdict::kBad;
  check.advice =
      "a policy or another program lowers this program's priority: start it from a plain command prompt";
  return check;
}

MachineCheck memory_check() {
  return {"locked memory", Verdict::kUnknown, "Windows locks no whole program",
          "end other programs, so that Windows moves none of this one's memory to the disk"};
}

MachineCheck timer_check() {
  MachineCheck check{
      "high-resolution timers", Verdict::kGood, "there are some (Windows 10, version 1803, or later)", {}};
  constexpr DWORD kHighResolution = 0x2;
  const HANDLE timer = CreateWaitableTimerExW(nullptr, nullptr, kHighResolution, TIMER_ALL_ACCESS);
  if (timer != nullptr) {
    CloseHandle(timer);
    return check;
  }
  check.verdict = Verdict::kBad;
  check.found = "none: a thread that sleeps wakes up to a millisecond late";
  check.advice = "update Windows, or use palpate run --poll";
  return check;
}

MachineCheck clock_check() {
  MachineCheck check{"clock", Verdict::kGood, {}, {}};
  LARGE_INTEGER rate{};
  QueryPerformanceFrequency(&rate);
  check.found = std::to_string(rate.QuadPart) + " steps a second";
  if (rate.QuadPart >= 1'000'000) return check;
  check.verdict = Verdict::kBad;
  check.advice = "remove useplatformclock (bcdedit /deletevalue useplatformclock), then start Windows again";
  return check;
}

MachineCheck processors_check() {
  MachineCheck check{"processors", Verdict::kGood, {}, {}};
  const std::size_t cores = usable_cores().size();
  check.found = std::to_string(cores) + " for this program";
  if (cores >= 2) return check;
  check.verdict = Verdict::kBad;
  check.advice = "one core must do everything: recorder and loop; two or more are wanted";
  return check;
}

MachineCheck power_check() {
  MachineCheck check{"power", Verdict::kUnknown, "the power plan cannot be read", {}};
  SYSTEM_POWER_STATUS status{};
  if (GetSystemPowerStatus(&status) != 0 && status.ACLineStatus == 0) {
    check.verdict = Verdict::kBad;
    check.found = "on battery";
    check.advice = "plug the computer in";
    return check;
  }
  GUID* scheme = nullptr;
  if (PowerGetActiveScheme(nullptr, &scheme) != ERROR_SUCCESS || scheme == nullptr) return check;
  // Windows' own plan "High performance", 8c5e7fda-e8bf-4a96-9a85-a6e23a8c635c.
  constexpr GUID kHigh{0x8c5e7fda, 0xe8bf, 0x4a96, {0x9a, 0x85, 0xa6, 0xe2, 0x3a, 0x8c, 0x63, 0x5c}};
  const bool high = IsEqualGUID(*scheme, kHigh) != 0;
  LocalFree(scheme);
  check.verdict = high ? Verdict::kGood : Verdict::kBad;
  check.found = high ? "plugged in, plan High performance" : "plugged in, another plan than High performance";
  if (!high) check.advice = "powercfg /setactive SCHEME_MIN";
  return check;
}

}  // namespace

std::vector<MachineCheck> check_machine(const std::filesystem::path& /*root*/) {
  return {system_check(), priority_check(),   memory_check(), timer_check(),
          clock_check(),  processors_check(), power_check()};
}

}  // namespace palpate::realtime
