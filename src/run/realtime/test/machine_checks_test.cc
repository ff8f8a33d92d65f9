#include "run/realtime/machine_checks.h"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"

namespace palpate::realtime {
namespace {

/// A folder that replaces the root folder of a machine that passes all checks.
class FakeRoot final {
 public:
  FakeRoot() {
    put("proc/self/status", "Name:\tpalpate\nCapEff:\t0000000000000000\n");
    limits("95", "unlimited");
    put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    put("proc/sys/kernel/sched_rt_period_us", "1000000\n");
    put("proc/self/timerslack_ns", "50000\n");
    put("proc/cmdline", "quiet\n");
    put("proc/version", "Linux version 6.1.0 (x) #1 SMP PREEMPT_RT Debian\n");
    put("sys/devices/system/clockevents/clockevent0/current_device", "lapic-deadline\n");
    put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
    put("sys/devices/system/clocksource/clocksource0/available_clocksource", "tsc hpet\n");
    put("sys/devices/system/cpu/online", "0-3\n");
    put("sys/devices/system/cpu/isolated", "3\n");
    for (const char* core : {"cpu0", "cpu1"}) {
      put(std::string("sys/devices/system/cpu/") + core + "/cpufreq/scaling_governor", "performance\n");
    }
  }
  void put(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  void limits(const std::string& priority, const std::string& memory) {
    put("proc/self/limits",
        "Limit                     Soft Limit           Hard Limit           Units\n"
        "Max locked memory         " +
            memory +
            "                 unlimited            bytes\n"
            "Max realtime priority     " +
            priority + "                    95\n");
  }
  [[nodiscard]] MachineCheck check(const std::string& name) const {
    for (const MachineCheck& check : check_machine(folder_.path())) {
      if (check.name == name) return check;
    }
    ADD_FAILURE() << "no check " << name;
    return {};
  }
  [[nodiscard]] std::vector<MachineCheck> all() const { return check_machine(folder_.path()); }

 private:
  palpate::test::TemporaryFolder folder_;
};

TEST(MachineChecks, AMachineInOrderIsGoodInEveryPoint) {
  const FakeRoot root;
  for (const MachineCheck& check : root.all()) {
    EXPECT_EQ(check.verdict, Verdict::kGood) << check.name << ": " << check.found;
    EXPECT_FALSE(check.found.empty()) << check.name;
  }
}

TEST(MachineChecks, WhereNothingCanBeReadNothingIsCalledBad) {
  const palpate::test::TemporaryFolder empty;
  const std::vector<MachineCheck> checks = check_machine(empty.path());
  EXPECT_EQ(checks.size(), 9u);
  for (const MachineCheck& check : checks) EXPECT_NE(check.verdict, Verdict::kBad) << check.name;
}

TEST(MachineChecks, APriorityLimitBelowTheWatchdogsIsBadUnlessTheCapabilityIsThere) {
  FakeRoot root;
  root.limits("84", "unlimited");
  EXPECT_EQ(root.check("real-time priority").verdict, Verdict::kBad);
  EXPECT_NE(root.check("real-time priority").advice.find("@realtime - rtprio 95"), std::string::npos);
  root.put("proc/self/status", "CapEff:\t0000000000800000\n");  // bit 23: CAP_SYS_NICE
  EXPECT_EQ(root.check("real-time priority").verdict, Verdict::kGood);
}

TEST(MachineChecks, AMemoryLimitOfEightMegabytesIsBadUnlessTheCapabilityIsThere) {
  FakeRoot root;
  root.limits("95", "8388608");
  EXPECT_EQ(root.check("locked memory").verdict, Verdict::kBad);
  EXPECT_NE(root.check("locked memory").advice.find("memlock unlimited"), std::string::npos);
  root.put("proc/self/status", "CapEff:\t0000000000004000\n");  // bit 14: CAP_IPC_LOCK
  EXPECT_EQ(root.check("locked memory").verdict, Verdict::kGood);
}

TEST(MachineChecks, EachThingThatIsWrongIsBadWithAdvice) {
  const std::vector<std::array<const char*, 3>> wrongs = {
      {"real-time throttling", "proc/sys/kernel/sched_rt_runtime_us", "100000\n"},
      {"high-resolution timers", "proc/cmdline", "quiet highres=off\n"},
      {"clock", "sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n"},
      {"kernel preemption", "proc/version", "Linux version 6.1.0 (x) #1 SMP Debian\n"},
      {"processors", "sys/devices/system/cpu/online", "0\n"},
      {"processor frequency", "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n"},
  };
  for (const auto& [name, file, text] : wrongs) {
    FakeRoot root;
    root.put(file, text);
    EXPECT_EQ(root.check(name).verdict, Verdict::kBad) << name;
    EXPECT_FALSE(root.check(name).advice.empty()) << name;
  }
}

TEST(MachineChecks, ADynamicKernelIsJudgedByWhatIsInForce) {
  FakeRoot root;
  root.put("proc/version", "Linux version 6.18 (x) #1 SMP PREEMPT_DYNAMIC\n");
  EXPECT_EQ(root.check("kernel preemption").verdict, Verdict::kUnknown);
  root.put("sys/kernel/debug/sched/preempt", "none (voluntary) full\n");
  EXPECT_EQ(root.check("kernel preemption").verdict, Verdict::kBad);
  root.put("sys/kernel/debug/sched/preempt", "none voluntary (full)\n");
  EXPECT_EQ(root.check("kernel preemption").verdict, Verdict::kGood);
}

TEST(WakeUpLatency, EveryDeadlineIsCountedHoweverItIsWaitedFor) {
  for (const haptics::Waiting waiting : {haptics::Waiting::kSleep, haptics::Waiting::kPoll}) {
    const WakeUpLatency wake_ups = measure_wake_up_latency(1000.0, 50, waiting);
    EXPECT_EQ(wake_ups.late.count(), 50u);
    EXPECT_LE(wake_ups.missed, 50u);
  }
}

}  // namespace
}  // namespace palpate::realtime
