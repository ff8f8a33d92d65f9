#include <string>
#include <thread>
#include <vector>

#include "io/system/clock.h"
#include "run/realtime/machine_checks.h"
#include "run/realtime/realtime.h"
#include "run/realtime/schedule.h"

namespace palpate::realtime {

WakeUpLatency measure_wake_up_latency(double rate_Hz, std::uint64_t ticks, haptics::Waiting waiting) {
  WakeUpLatency result;
  std::vector<std::string> remarks;
  const MemoryLock memory(remarks);
  result.memory_locked = memory.granted();
  std::thread thread([&] {
    result.realtime_priority = !request_priority(Urgency::kLoop).has_value();
    prefault_stack();
    TickWait wait(waiting, rate_Hz);
    Schedule schedule(rate_Hz, monotonic_ns() + static_cast<std::int64_t>(1e9 / rate_Hz));
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      wait.until(schedule.due());
      const Schedule::Begin begin = schedule.begin(monotonic_ns());
      result.late.add(begin.late_ns);
      if (begin.missed) ++result.missed;
    }
  });
  thread.join();
  return result;
}

}  // namespace palpate::realtime
