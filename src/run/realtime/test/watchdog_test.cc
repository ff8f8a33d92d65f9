#include "run/realtime/watchdog.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"

namespace palpate::realtime {
namespace {

using haptics::test::FakeDevice;
using namespace std::chrono_literals;

constexpr std::int64_t kStalledAfter = 50'000'000;  // ns

FakeDevice still() {
  return FakeDevice([](std::uint64_t, double) { return haptics::DeviceState{}; });
}

/// Waits until the device was stopped `times` times, for at most a minute. @return whether it was
bool stopped(const FakeDevice& device, int times) {
  for (int i = 0; i < 60'000; ++i) {
    if (device.stops >= times) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

TEST(Watchdog, StopsEveryDeviceOncePerStallAndSaysAfterWhichTick) {
  FakeDevice first = still();
  FakeDevice second = still();
  haptics::Device* devices[] = {&first, &second};
  Watchdog watchdog(devices, kStalledAfter);
  watchdog.beat(7, monotonic_ns());
  ASSERT_TRUE(stopped(second, 1));
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(watchdog.stops(), 1u) << "one stall, one stop";
  watchdog.beat(8, monotonic_ns());
  ASSERT_TRUE(stopped(second, 2));
  const std::vector<haptics::WatchdogStop> kept = watchdog.finish();
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].tick, 7u);
  EXPECT_EQ(kept[0].after_ns, kStalledAfter) << "its time is that of the last begin and the limit";
  EXPECT_EQ(kept[1].tick, 8u);
  EXPECT_GE(kept[1].after_ns, 2 * kStalledAfter);
  EXPECT_EQ(first.stops, 2);
  EXPECT_EQ(second.stops, 2);
}

TEST(Watchdog, DoesNothingBeforeTheFirstTickAndAfterTheLast) {
  FakeDevice device = still();
  haptics::Device* devices[] = {&device};
  Watchdog watchdog(devices, 1'000'000);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(device.stops, 0) << "no tick had begun";
  Watchdog patient(devices, 60'000'000'000);
  patient.beat(0, monotonic_ns());
  patient.rest();
  std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(patient.finish().empty());
  EXPECT_EQ(device.stops, 0);
}

TEST(Watchdog, KeepsTheFirstStopsAndCountsTheRest) {
  FakeDevice device = still();
  haptics::Device* devices[] = {&device};
  Watchdog watchdog(devices, 1);
  const auto most = static_cast<int>(haptics::WatchdogStop::kMaxKept);
  for (int i = 0; i < most + 3; ++i) {
    watchdog.beat(static_cast<std::uint64_t>(i), monotonic_ns());
    ASSERT_TRUE(stopped(device, i + 1));
  }
  const std::vector<haptics::WatchdogStop> kept = watchdog.finish();
  EXPECT_EQ(kept.size(), haptics::WatchdogStop::kMaxKept);
  EXPECT_EQ(watchdog.stops(), haptics::WatchdogStop::kMaxKept + 3);
}

}  // namespace
}  // namespace palpate::realtime
