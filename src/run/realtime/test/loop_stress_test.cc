// Everything that shares memory with the loop at the same time: the renderer's snapshots, fault reports,
// resets, progress, and a watchdog that fires repeatedly. The test is for the thread sanitizer; .ci/run gives
// it a minute.
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/spsc_queue.h"
#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"
#include "run/realtime/loop.h"

namespace palpate::realtime {
namespace {

double stress_seconds() {
  const char* text = std::getenv("PALPATE_STRESS_S");  // NOLINT(concurrency-mt-unsafe): nothing writes it
  return text == nullptr ? 2.0 : std::stod(text);
}

/// Presses, and sometimes halts for longer than the watchdog waits.
class HangingDevice final : public haptics::Device {
 public:
  explicit HangingDevice(std::int64_t hang_ns) : hang_ns_(hang_ns) {}

  haptics::DeviceState read(std::uint64_t tick, double) noexcept override {
    constexpr std::uint64_t kBetweenHangs = 200;  // ticks
    if (tick % kBetweenHangs == kBetweenHangs - 1) sleep_until_ns(monotonic_ns() + hang_ns_);
    haptics::DeviceState sample = haptics::test::pressing(0.5);
    if (tick % 1'000 == 500) sample.fault = haptics::Fault::kDevice;
    return sample;
  }
  bool write(const haptics::ForceCommand& command) noexcept override {
    force_.store(command.force.norm());
    return true;
  }
  void stop() noexcept override {
    force_.store(0.0);
    stops_.fetch_add(1);
  }
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return ~std::uint64_t{0}; }

  [[nodiscard]] std::uint64_t stops() const noexcept { return stops_.load(); }

 private:
  std::int64_t hang_ns_;
  std::atomic<double> force_{0.0};
  std::atomic<std::uint64_t> stops_{0};
};

/// All observers of the loop on other threads, until `over` is set.
struct Observers final : haptics::TickObserver {
  void on_fault(const haptics::FaultSeen& fault) noexcept override { (void)news.push(fault); }
  void on_tick(const haptics::TickState& now) noexcept override { progress.store(now.tick + 1); }

  haptics::SnapshotPublisher publisher;
  SpscQueue<haptics::FaultSeen> news{64};
  std::atomic<std::uint64_t> progress{0};
  haptics::RunControl control;
  std::uint64_t snapshots = 0;  // received by the drawing thread
  std::uint64_t torn = 0;
  std::uint64_t heard = 0;  // faults received by the reporting thread

  void draw(const std::atomic<bool>& over) {
    std::uint64_t last = 0;
    while (!over) {
      if (publisher.cell().refresh()) {
        ++snapshots;
        const haptics::Snapshot& newest = publisher.cell().value();
        if (newest.hands != 2 || newest.tick < last) ++torn;
        last = newest.tick;
      }
      sleep_until_ns(monotonic_ns() + 100'000);
    }
  }

  void talk(const std::atomic<bool>& over) {
    haptics::FaultSeen seen;
    while (!over) {
      while (news.pop(seen)) ++heard;
      control.reset_faults(0b11);
      sleep_until_ns(monotonic_ns() + 3'000'000);
    }
    while (news.pop(seen)) ++heard;
  }
};

TEST(LoopStress, LoopHandOverWatchdogAndResetsTogether) {
  constexpr double kRate = 4000.0;
  constexpr std::int64_t kStall = 5'000'000;  // ns
  const haptics::SimulationWorld world = haptics::test::block_and_balls(2, kRate);
  haptics::SimulationState state(world);
  HangingDevice left(2 * kStall);
  HangingDevice right(0);
  haptics::Device* devices[] = {&left, &right};
  Observers observers;
  LoopOptions options{.ticks = ~std::uint64_t{0}, .control = &observers.control};
  options.stalled_after_ns = kStall;

  std::atomic<bool> over{false};
  std::thread draws([&] { observers.draw(over); });
  std::thread talks([&] { observers.talk(over); });
  std::thread ends([&] {
    sleep_until_ns(monotonic_ns() + static_cast<std::int64_t>(stress_seconds() * 1e9));
    observers.control.stop();
  });
  const haptics::LoopReport report =
      run_loop(world, state, devices, {&observers.publisher, &observers}, options);
  ends.join();
  over = true;
  draws.join();
  talks.join();

  EXPECT_EQ(observers.torn, 0u);
  EXPECT_GT(observers.snapshots, 0u);
  EXPECT_EQ(observers.progress.load(), report.ticks);
  EXPECT_GT(report.watchdog_stops, 0u);
  EXPECT_GE(left.stops(), report.watchdog_stops);
  EXPECT_EQ(report.fault, haptics::Fault::kStalled);
  EXPECT_GE(observers.heard, 1u);
  std::cout << report.ticks << " ticks, " << report.watchdog_stops << " stops by the watchdog, "
            << report.faults.size() + report.further_faults << " faults latched, " << observers.heard
            << " heard of, " << observers.snapshots << " snapshots\n";
}

}  // namespace
}  // namespace palpate::realtime
