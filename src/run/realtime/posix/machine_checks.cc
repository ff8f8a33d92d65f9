#include "run/realtime/machine_checks.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "run/realtime/realtime.h"

namespace palpate::realtime {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMayRaisePriority = 23;  // bits of a process's capabilities: CAP_SYS_NICE
constexpr unsigned kMayLockMemory = 14;     // CAP_IPC_LOCK
constexpr double kLockedBytes = 512e6;      // memory of the largest built-in scenes, with a margin
constexpr long kWantedPriority = 85;        // of the watchdog, the highest that Palpate requests

std::optional<std::string> first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) return std::nullopt;
  return line;
}

std::optional<long> whole_number(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  char* end = nullptr;
  const long value = std::strtol(text->c_str(), &end, 10);
  return end == text->c_str() ? std::nullopt : std::optional(value);
}

/// The rest of the line of `file` that begins with `start`, without the blanks before it.
std::optional<std::string> line_after(const fs::path& file, const std::string& start) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(start, 0) != 0) continue;
    const std::size_t from = line.find_first_not_of(" \t", start.size());
    return from == std::string::npos ? std::string() : line.substr(from);
  }
  return std::nullopt;
}

bool may(const fs::path& root, unsigned capability) {
  const std::optional<std::string> mask = line_after(root / "proc/self/status", "CapEff:");
  if (!mask) return false;
  return ((std::strtoull(mask->c_str(), nullptr, 16) >> capability) & 1ULL) != 0;
}

/// The soft limit of the process as text: a number or "unlimited".
std::optional<std::string> limit(const fs::path& root, const std::string& name) {
  const std::optional<std::string> line = line_after(root / "proc/self/limits", name);
  if (!line) return std::nullopt;
  return line->substr(0, line->find(' '));
}

MachineCheck priority(const fs::path& root) {
  MachineCheck check{"real-time priority", Verdict::kGood, {}, {}};
  const std::optional<std::string> allowed = limit(root, "Max realtime priority");
  if (may(root, kMayRaisePriority)) {
    check.found = "allowed by CAP_SYS_NICE";
  } else if (!allowed) {
    check.verdict = Verdict::kUnknown;
    check.found = "the limit cannot be read";
  } else if (*allowed == "unlimited" || whole_number(allowed).value_or(0) >= kWantedPriority) {
    check.found = "rtprio limit " + *allowed;
  } else {
    check.verdict = Verdict::kBad;
    check.found = "rtprio limit " + *allowed + ", " + std::to_string(kWantedPriority) +
                  " is wanted, and no CAP_SYS_NICE";
    check.advice =
        "put '@realtime - rtprio 95' into /etc/security/limits.d/realtime.conf, add yourself to that group "
        "(groupadd realtime; usermod -aG realtime USER) and log in again; in a container: --cap-add SYS_NICE "
        "--ulimit rtprio=95";
  }
  return check;
}

MachineCheck memory_lock(const fs::path& root) {
  MachineCheck check{"locked memory", Verdict::kGood, {}, {}};
  const std::optional<std::string> allowed = limit(root, "Max locked memory");
  if (may(root, kMayLockMemory)) {
    check.found = "allowed by CAP_IPC_LOCK";
  } else if (!allowed) {
    check.verdict = Verdict::kUnknown;
    check.found = "the limit cannot be read";
  } else if (*allowed == "unlimited" ||
             static_cast<double>(whole_number(allowed).value_or(0)) >= kLockedBytes) {
    check.found = "memlock limit " + *allowed + (*allowed == "unlimited" ? "" : " bytes");
  } else {
    check.verdict = Verdict::kBad;
    check.found = "memlock limit " + *allowed + " bytes, and no CAP_IPC_LOCK";
    check.advice =
        "put '@realtime - memlock unlimited' into /etc/security/limits.d/realtime.conf and log in again; in "
        "a container: --ulimit memlock=-1";
  }
  return check;
}

MachineCheck throttling(const fs::path& root) {
  MachineCheck check{"real-time throttling", Verdict::kGood, {}, {}};
  const std::optional<RealtimeBudget> budget = realtime_budget(root);
  if (!budget) {
    check.verdict = Verdict::kUnknown;
    check.found = "sched_rt_runtime_us cannot be read";
    return check;
  }
  const auto [runtime, period] = *budget;
  if (runtime < 0) {
    check.found = "off";
  } else if (runtime > 0 && 2 * runtime >= period) {
    check.found = "after " + std::to_string(runtime) + " of " + std::to_string(period) +
                  " us; the loop sleeps most of the time, and with --poll enough of it";
  } else {
    check.verdict = Verdict::kBad;
    check.found = "after " + std::to_string(runtime) + " of " + std::to_string(period) + " us";
    check.advice = "sysctl -w kernel.sched_rt_runtime_us=950000";
  }
  return check;
}

MachineCheck timer_slack(const fs::path& root) {
  MachineCheck check{"timer slack", Verdict::kGood, {}, {}};
  const std::optional<long> slack = whole_number(first_line(root / "proc/self/timerslack_ns"));
  check.found = slack ? std::to_string(*slack) + " ns here; the loop's thread sets its own to 1 ns"
                      : "cannot be read; the loop's thread sets its own to 1 ns";
  return check;
}

MachineCheck clock_source(const fs::path& root) {
  MachineCheck check{"clock", Verdict::kGood, {}, {}};
  const fs::path folder = root / "sys/devices/system/clocksource/clocksource0";
  const std::optional<std::string> source = first_line(folder / "current_clocksource");
  if (!source) {
    check.verdict = Verdict::kUnknown;
    check.found = "the clock source cannot be read";
    return check;
  }
  check.found = *source;
  static constexpr const char* kQuick[] = {"tsc", "arch_sys_counter", "kvm-clock",
                                           "hyperv_clocksource_tsc_page"};
  if (std::find(std::begin(kQuick), std::end(kQuick), *source) != std::end(kQuick)) return check;
  check.verdict = Verdict::kBad;
  check.found += ": reading it takes a microsecond or more";
  check.advice = "boot with clocksource=tsc where the processor's counter is steady (available: " +
                 first_line(folder / "available_clocksource").value_or("unknown") + ")";
  return check;
}

MachineCheck timers(const fs::path& root) {
  MachineCheck check{"high-resolution timers", Verdict::kGood, {}, {}};
  const std::optional<std::string> event =
      first_line(root / "sys/devices/system/clockevents/clockevent0/current_device");
  const std::optional<std::string> command = first_line(root / "proc/cmdline");
  if (command && command->find("highres=off") != std::string::npos) {
    check.verdict = Verdict::kBad;
    check.found = "off (highres=off on the kernel's command line)";
    check.advice = "boot without highres=off";
  } else if (event) {
    check.found = "on, by " + *event;
  } else {
    check.verdict = Verdict::kUnknown;
    check.found = "the kernel does not say which timer it uses; see the wake-ups below";
  }
  return check;
}

MachineCheck preemption(const fs::path& root) {
  MachineCheck check{"kernel preemption", Verdict::kGood, {}, {}};
  const std::string version = first_line(root / "proc/version").value_or("");
  if (whole_number(first_line(root / "sys/kernel/realtime")).value_or(0) == 1 ||
      version.find("PREEMPT_RT") != std::string::npos) {
    check.found = "PREEMPT_RT";
  } else if (version.empty()) {
    check.verdict = Verdict::kUnknown;
    check.found = "/proc/version cannot be read";
  } else {
    const bool dynamic = version.find("PREEMPT_DYNAMIC") != std::string::npos;
    // The active mode of dynamic preemption is in brackets; only root may read it.
    const std::string chosen = first_line(root / "sys/kernel/debug/sched/preempt").value_or("");
    const bool full =
        dynamic ? chosen.find("(full)") != std::string::npos : version.find(" PREEMPT ") != std::string::npos;
    check.verdict = full ? Verdict::kGood : Verdict::kBad;
    check.found = full ? "PREEMPT, full"
                  : dynamic
                      ? "PREEMPT_DYNAMIC, set at boot: " + (chosen.empty() ? "to what is not known" : chosen)
                      : "none: the kernel may hold a processor for milliseconds";
    if (dynamic && !full && chosen.empty()) check.verdict = Verdict::kUnknown;
    if (dynamic && !full) check.advice = "boot with preempt=full, or install linux-image-rt-amd64";
    if (!dynamic && !full) check.advice = "install linux-image-rt-amd64";
  }
  return check;
}

MachineCheck processors(const fs::path& root) {
  MachineCheck check{"processors", Verdict::kUnknown, {}, {}};
  const fs::path folder = root / "sys/devices/system/cpu";
  const std::optional<std::string> online = first_line(folder / "online");
  const std::string isolated = first_line(folder / "isolated").value_or("");
  if (!online) {
    check.found = "/sys/devices/system/cpu/online cannot be read";
    return check;
  }
  check.found = "online " + *online + ", isolated " + (isolated.empty() ? "none" : isolated);
  check.verdict = *online == "0" ? Verdict::kBad : Verdict::kGood;
  if (*online == "0") {
    check.advice = "one core must do everything: picture, recorder and loop; two or more are wanted";
  } else if (isolated.empty()) {
    check.advice = "for the quietest loop: boot with isolcpus=N and use palpate run --core N";
  } else {
    check.advice = "use palpate run --core N with one of the isolated cores";
  }
  return check;
}

MachineCheck governor(const fs::path& root) {
  MachineCheck check{"processor frequency", Verdict::kUnknown, {}, {}};
  std::map<std::string, int> governors;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(root / "sys/devices/system/cpu", error)) {
    const std::optional<std::string> name = first_line(entry.path() / "cpufreq/scaling_governor");
    if (name) ++governors[*name];
  }
  if (governors.empty()) {
    check.found = "no governor to be seen (a virtual machine, or no cpufreq)";
    return check;
  }
  for (const auto& [name, cores] : governors) {
    check.found += (check.found.empty() ? "" : ", ") + name + " on " + std::to_string(cores) +
                   (cores == 1 ? " core" : " cores");
  }
  check.verdict = governors.size() == 1 && governors.contains("performance") ? Verdict::kGood : Verdict::kBad;
  if (check.verdict == Verdict::kBad) check.advice = "cpupower frequency-set -g performance";
  return check;
}

}  // namespace

std::vector<MachineCheck> check_machine(const fs::path& root) {
  return {priority(root),     memory_lock(root), throttling(root), timer_slack(root), timers(root),
          clock_source(root), preemption(root),  processors(root), governor(root)};
}

}  // namespace palpate::realtime
