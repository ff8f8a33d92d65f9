// Faults of Haply's service, and the force on the hand. The device runs in the loop in step with a stand-in
// service. The fault comes while the tool presses, and the hand presses again after a reset.
#include <atomic>
#include <chrono>
#include <cmath>
#include <ostream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "io/websocket/test/haply_service.h"
#include "run/devices/haply.h"
#include "run/devices/test/emulated_scene.h"
#include "run/devices/test/safety_line.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using haptics::TickRow;
using test::Answer;

constexpr std::uint64_t kHaplyFaultTick = 1500;
constexpr std::uint64_t kMendTick = 1600;   // the service works again
constexpr std::uint64_t kResetTick = 2000;  // the tool is outside again
constexpr std::uint64_t kHaplyLastTick = 3600;
constexpr std::uint64_t kHaplyNever = ~std::uint64_t{0};

/// Path: outside and still for 1 s, 6 mm in the block at 1.4 s, outside and still from 2 s, in the block
/// again from 3 s.
scene::ToolPath way() {
  return test::heights(
      {{0.0, 8e-3}, {1.0, 8e-3}, {1.4, -6e-3}, {1.7, -6e-3}, {1.95, 8e-3}, {3.0, 8e-3}, {3.4, -6e-3}});
}

struct HaplyCase {
  const char* fault;
  const char* injected;
  Fault cause;
  Answer (*answer)(const Vec3& position);

  friend std::ostream& operator<<(std::ostream& out, const HaplyCase& one) { return out << one.fault; }
};

std::string arm_that_says(const Vec3& position, const char* key, bool value) {
  nlohmann::json arm = test::arm_json("04BA", position);
  arm["status"][key] = value;
  return nlohmann::json{{"inverse3", {arm}}}.dump();
}

const HaplyCase kHaplyCases[] = {
    {"silent", "no reply at all for 100 ticks", Fault::kStale, [](const Vec3&) { return Answer{}; }},
    {"closes", "the service closes the connection", Fault::kDevice,
     [](const Vec3&) {
       return Answer{{}, Answer::Then::kClose};
     }},
    {"breaks off", "the connection breaks off", Fault::kDevice,
     [](const Vec3&) {
       return Answer{{}, Answer::Then::kBreakOff};
     }},
    {"no JSON", "replies that are no JSON", Fault::kDevice,
     [](const Vec3&) { return Answer{"{\"inverse3\": ["}; }},
    {"a field is missing", "replies without a position", Fault::kDevice,
     [](const Vec3&) { return Answer{R"({"inverse3":[{"device_id":"04BA","state":{}}]})"}; }},
    {"no number", "replies with null where a number is due", Fault::kDevice,
     [](const Vec3& position) {
       nlohmann::json arm = test::arm_json("04BA", position);
       arm["state"]["cursor_position"]["x"] = nullptr;
       return Answer{nlohmann::json{{"inverse3", {arm}}}.dump()};
     }},
    {"the arm is gone", "replies without the arm", Fault::kDevice,
     [](const Vec3&) { return Answer{R"({"inverse3":[]})"}; }},
    {"no power", "the arm says that it has no power supply", Fault::kForceOff,
     [](const Vec3& position) { return Answer{arm_that_says(position, "power_supply", false)}; }},
    {"not ready", "the arm says that it is not ready", Fault::kForceOff,
     [](const Vec3& position) { return Answer{arm_that_says(position, "ready", false)}; }},
};

/// Position of the arm and state of the service, shared with the service's threads.
struct World {
  std::atomic<double> height{0.0};
  std::atomic<bool> broken{false};

  [[nodiscard]] Vec3 position() const { return {0.001, 0.002, height.load()}; }
};

/// Runs the device in step with the service. A tick waits until the sample has the arm's present position, or
/// shows the fault that is due. The result does not depend on the machine's speed.
class InStep final : public haptics::Device {
 public:
  InStep(HaplyDevice& device, World& world) : device_(device), world_(world), path_(way()) {}

  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    world_.height = path_.at(time).position.z();
    world_.broken = tick >= kHaplyFaultTick && tick < kMendTick;
    haptics::DeviceState sample = sample_when([&](const haptics::DeviceState& s) {
      const bool shows = s.fault != Fault::kNone || s.age > haptics::kStaleAfter;
      return world_.broken ? shows : !shows && s.position_D == world_.position();
    });
    sample.age = world_.broken ? sample.age : 0.0;  // delays by the machine's other work do not count
    if (tick == kResetTick) sample.events = haptics::kResetFault;
    return sample;
  }
  bool write(const haptics::ForceCommand& command_D) noexcept override { return device_.write(command_D); }
  void stop() noexcept override { device_.stop(); }
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return kHaplyLastTick; }

 private:
  template <typename Wanted>
  haptics::DeviceState sample_when(const Wanted& wanted) noexcept {
    haptics::DeviceState sample = device_.read(0, 0.0);
    for (int i = 0; i < 200'000 && !wanted(sample); ++i) {  // at least 10 s
      (void)device_.write({});                              // shows that the loop still runs
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      sample = device_.read(0, 0.0);
    }
    return sample;
  }

  HaplyDevice& device_;
  World& world_;
  scene::ToolPath path_;
};

std::vector<TickRow> run_haply_with(const HaplyCase& bad) {
  World world;
  world.height = way().at(0.0).position.z();
  const test::HaplyService service(test::one_arm(world.position()), [&](std::size_t) {
    return world.broken ? bad.answer(world.position()) : Answer{test::one_arm(world.position())};
  });
  HaplyTimes times;
  times.retry = 20'000'000;
  HaplyDevice device(service.address(), 0, times);
  InStep stepped(device, world);
  scene::Scene scene = test::block_and_hand();
  scene.devices[0].kind = "haply";
  return test::run_through(scene, stepped);
}

class HaplySafety : public ::testing::TestWithParam<HaplyCase> {};

TEST_P(HaplySafety, TheForceFallsToZeroStaysThereAndComesBackOnlyAfterAReset) {
  const HaplyCase& bad = GetParam();
  const std::vector<TickRow> rows = run_haply_with(bad);
  ASSERT_EQ(rows.size(), kHaplyLastTick);
  std::uint64_t zero = kHaplyNever;
  ASSERT_GT(test::force_of(rows[kHaplyFaultTick - 1]).norm(), 0.1) << "pressing";
  for (std::uint64_t tick = kHaplyFaultTick; tick < kResetTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, static_cast<std::uint32_t>(bad.cause)) << tick;
    const double force = test::force_of(rows[tick]).norm();
    if (zero == kHaplyNever && force == 0.0) zero = tick;
    if (zero != kHaplyNever) {
      ASSERT_EQ(force, 0.0) << tick;
    }
  }
  EXPECT_LE(zero, kHaplyFaultTick + 10) << "10 ms at 1 kHz";
  double largest_step = 0.0;
  for (std::uint64_t tick = kResetTick; tick < kHaplyLastTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, 0U) << tick;
    largest_step =
        std::max(largest_step, (test::force_of(rows[tick]) - test::force_of(rows[tick - 1])).norm());
  }
  EXPECT_LT(largest_step, 0.1) << "N a tick: noise and tissue only, never a jump";
  EXPECT_GT(test::force_of(rows.back()).norm(), 0.05) << "felt again";
  palpate::test::tell({"haply", bad.fault, std::string(bad.injected) + ", while pressing",
                       static_cast<double>(zero - kHaplyFaultTick), haptics::name_of(bad.cause),
                       "reset, then force again by the ramp", !HasFailure()});
}

INSTANTIATE_TEST_SUITE_P(Service, HaplySafety, ::testing::ValuesIn(kHaplyCases));

}  // namespace
}  // namespace palpate::devices
