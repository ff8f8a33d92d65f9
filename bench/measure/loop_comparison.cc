#include "bench/measure/loop_comparison.h"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/system/clock.h"
#include "palpate/scripted_device.h"
#include "run/realtime/realtime.h"
#include "run/realtime/schedule.h"

#include "bench/measure/one_hand.h"

namespace palpate::bench {
namespace {

constexpr double kTurn = 0.25;  // s

/// State of one of the two loops.
struct Side {
  std::vector<double> late_us;
  std::uint64_t missed = 0;
};

/// Runs `ticks` periods in real time with a call of `work()` in each.
template <typename Work>
void take_turn(double rate_Hz, std::uint64_t ticks, realtime::TickWait& wait, Side& side, Work work) {
  const auto period = static_cast<std::int64_t>(1e9 / rate_Hz);
  realtime::Schedule schedule(rate_Hz, monotonic_ns() + period);
  for (std::uint64_t i = 0; i < ticks; ++i) {
    wait.until(schedule.due());
    const realtime::Schedule::Begin begin = schedule.begin(monotonic_ns());
    side.late_us.push_back(static_cast<double>(begin.late_ns) / kNanosecondsPerMicrosecond);
    if (begin.missed) ++side.missed;
    work();
  }
}

}  // namespace

LoopAccount compare_with_empty_loop(const scene::Scene& scene, const haptics::SimulationWorld& world,
                                    const scene::ToolPath& path, haptics::Waiting waiting,
                                    const Watch& watch) {
  devices::ScriptedDevice device(path);
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  const auto turn = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(kTurn * world.rate_Hz));
  Side with;
  Side empty;
  with.late_us.reserve(last);
  empty.late_us.reserve(last);
  OneHand hand(world);
  ScratchRecorder recorder(scene);
  std::vector<std::string> remarks;
  const realtime::MemoryLock memory(remarks);
  std::thread thread([&] {
    (void)realtime::request_priority(realtime::Urgency::kLoop);
    realtime::prefault_stack();
    realtime::TickWait wait(waiting, world.rate_Hz);
    for (std::uint64_t number = 0; number < last;) {
      watch(static_cast<double>(number) / static_cast<double>(last),
            "loop of the " + scene.name + " scene against an empty one");
      const std::uint64_t ticks = std::min(turn, last - number);
      take_turn(world.rate_Hz, ticks, wait, empty, [] {});
      take_turn(world.rate_Hz, ticks, wait, with, [&] { recorder.on_row(hand.tick(device, number++)); });
    }
  });
  thread.join();
  LoopAccount account;
  account.scene = scene.name;
  account.rate_Hz = world.rate_Hz;
  account.ticks = last;
  account.missed = with.missed;
  account.missed_empty = empty.missed;
  account.late = figures_of(std::move(with.late_us));
  account.late_empty = figures_of(std::move(empty.late_us));
  return account;
}

}  // namespace palpate::bench
