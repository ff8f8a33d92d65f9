// Faults of a Touch, of OpenHaptics and of its scheduler, and the force on the hand. The device runs in the
// loop in step with the stand-in's scheduler. The fault comes while the tool presses, and the hand presses
// again after a reset.
#include <chrono>
#include <cmath>
#include <limits>
#include <ostream>
#include <thread>

#include <gtest/gtest.h>

#include "run/devices/test/emulated_scene.h"
#include "run/devices/test/safety_line.h"
#include "run/devices/test/stand_in/hd_stand_in_loaded.h"
#include "run/devices/touch.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using haptics::TickRow;
using stand_in::HdArm;
using stand_in::HdWorld;
using stand_in::LoadedHd;

constexpr std::uint64_t kTouchFaultTick = 1500;
constexpr std::uint64_t kTouchMendTick = 1600;   // the arm works again
constexpr std::uint64_t kTouchResetTick = 2000;  // the tool is outside again
constexpr std::uint64_t kTouchLastTick = 3600;
constexpr std::uint64_t kTouchNever = ~std::uint64_t{0};

/// Path: outside and still for 1 s, 6 mm in the block at 1.4 s, outside and still from 2 s, in the block
/// again from 3 s.
scene::ToolPath touch_path() {
  return test::heights(
      {{0.0, 8e-3}, {1.0, 8e-3}, {1.4, -6e-3}, {1.7, -6e-3}, {1.95, 8e-3}, {3.0, 8e-3}, {3.4, -6e-3}});
}

struct TouchCase {
  const char* name;
  const char* fault;
  const char* injected;
  Fault cause;
  void (*inject)(HdArm& arm);     // null: the scheduler fails instead
  std::uint64_t frame_every = 1;  // ticks per frame of the failing scheduler; 0: no frames

  friend std::ostream& operator<<(std::ostream& out, const TouchCase& one) { return out << one.name; }
};

template <unsigned kCode>
void raise(HdArm& arm) {
  arm.frame_error = kCode;
}

constexpr const char* kAtTheFrame = "this error at every frame for 100 ticks";

const TouchCase kTouchCases[] = {
    {"Silent", "silent scheduler", "no callback for 100 ticks", Fault::kStale, nullptr, 0},
    {"Slow", "slow scheduler", "a callback every 20 ticks, for 100 ticks", Fault::kStale, nullptr, 20},
    {"Inkwell", "stylus in the inkwell", "its inkwell switch opens", Fault::kForceOff,
     [](HdArm& arm) { arm.in_inkwell = true; }},
    {"LetGo", "stylus let go", "its safety switch opens", Fault::kForceOff,
     [](HdArm& arm) { arm.held = false; }},
    {"ForceDisabled", "force output off", "the library says that force output is off", Fault::kForceOff,
     [](HdArm& arm) { arm.force_enabled = false; }},
    {"NaNPosition", "NaN as position", "a position that is no number", Fault::kNotFinite,
     [](HdArm& arm) { arm.position[0] = std::numeric_limits<double>::quiet_NaN(); }},
    {"NaNRotation", "NaN in the rotation", "a transform that is no number", Fault::kNotFinite,
     [](HdArm& arm) { arm.transform[5] = std::numeric_limits<double>::quiet_NaN(); }},
    {"WarmMotors", "warm motors (0x0200)", kAtTheFrame, Fault::kForceOff, raise<0x0200>},
    {"MaxForce", "force exceeded (0x0201)", kAtTheFrame, Fault::kForceOff, raise<0x0201>},
    {"Impulse", "force impulse exceeded (0x0202)", kAtTheFrame, Fault::kForceOff, raise<0x0202>},
    {"Velocity", "velocity exceeded (0x0203)", kAtTheFrame, Fault::kForceOff, raise<0x0203>},
    {"ForceError", "force error (0x0204)", kAtTheFrame, Fault::kForceOff, raise<0x0204>},
    {"DeviceFault", "device fault (0x0300)", kAtTheFrame, Fault::kDevice, raise<0x0300>},
    {"AlreadyOpen", "already initiated (0x0301)", kAtTheFrame, Fault::kDevice, raise<0x0301>},
    {"Communication", "communication error (0x0302)", kAtTheFrame, Fault::kDevice, raise<0x0302>},
    {"Configuration", "communication configuration (0x0303)", kAtTheFrame, Fault::kDevice, raise<0x0303>},
    {"Timer", "timer error (0x0304)", kAtTheFrame, Fault::kDevice, raise<0x0304>},
    {"Frame", "frame error (0x0402)", kAtTheFrame, Fault::kDevice, raise<0x0402>},
    {"SchedulerFull", "scheduler full (0x0501)", kAtTheFrame, Fault::kDevice, raise<0x0501>},
    {"Licence", "invalid licence (0x0600)", kAtTheFrame, Fault::kDevice, raise<0x0600>},
};

/// Puts a faultless arm at `p` [m, in D] and switches its force on. The arm's numbers are in mm in the
/// vendor's frame.
void put(HdArm& arm, const Vec3& p) {
  const double position[3] = {1e3 * p.x(), 1e3 * p.z(), -1e3 * p.y()};
  std::copy_n(position, 3, arm.position);
  const double upright[16] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
  std::copy_n(upright, 16, arm.transform);
  arm.held = arm.force_enabled = true;
  arm.in_inkwell = false;
  arm.frame_error = 0;
}

/// Runs the device in step with the scheduler. Each tick asks for one frame, and the age of its sample counts
/// as zero. The result does not depend on the machine's speed. A failing scheduler is the exception: the
/// clock gives its samples' age.
class TouchInStep final : public haptics::Device {
 public:
  TouchInStep(TouchDevice& device, const LoadedHd& hd, const TouchCase& bad)
      : device_(device), hd_(hd), bad_(bad), path_(touch_path()) {}

  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    const bool broken = tick >= kTouchFaultTick && tick < kTouchMendTick;
    hd_.arm([&](HdArm& arm) {
      put(arm, path_.at(time).position);
      if (broken && bad_.inject != nullptr) bad_.inject(arm);
    });
    const bool slow = broken && bad_.inject == nullptr;
    if (!slow || (bad_.frame_every > 0 && tick % bad_.frame_every == 0)) hd_.step();
    haptics::DeviceState sample = device_.read(tick, time);
    if (slow) {
      const bool due = bad_.frame_every == 0 || tick % bad_.frame_every != 0;
      while (due && sample.age <= haptics::kStaleAfter) sample = device_.read(tick, time);
      return sample;
    }
    for (int i = 0; !broken && sample.fault != Fault::kNone && i < 10'000;
         ++i) {  // until the device no longer shows the fault
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      hd_.step();
      sample = device_.read(tick, time);
    }
    sample.age = 0.0;
    if (tick == kTouchResetTick) sample.events = haptics::kResetFault;
    return sample;
  }
  bool write(const haptics::ForceCommand& command_D) noexcept override { return device_.write(command_D); }
  void stop() noexcept override { device_.stop(); }
  [[nodiscard]] std::uint64_t last_tick(double) const noexcept override { return kTouchLastTick; }

 private:
  TouchDevice& device_;
  const LoadedHd& hd_;
  const TouchCase& bad_;
  scene::ToolPath path_;
};

std::vector<TickRow> run_touch_with(const TouchCase& bad, std::string& last_error) {
  const LoadedHd hd;
  hd.arm([](HdArm& arm) { put(arm, touch_path().at(0.0).position); });
  TouchDevice device("");
  hd.set([](HdWorld& world) { world.stepped = true; });
  TouchInStep stepped(device, hd, bad);
  scene::Scene scene = test::block_and_hand();
  scene.devices[0].kind = "touch";
  std::vector<TickRow> rows = test::run_through(scene, stepped);
  last_error = device.last_error();
  hd.set([](HdWorld& world) { world.stepped = false; });
  return rows;
}

class TouchSafety : public ::testing::TestWithParam<TouchCase> {};

TEST_P(TouchSafety, TheForceFallsToZeroStaysThereAndComesBackOnlyAfterAReset) {
  const TouchCase& bad = GetParam();
  std::string last_error;
  const std::vector<TickRow> rows = run_touch_with(bad, last_error);
  ASSERT_EQ(rows.size(), kTouchLastTick);
  if (bad.cause != Fault::kNotFinite) {
    EXPECT_NE(last_error, "") << "the reason, as text";
  }
  ASSERT_GT(test::force_of(rows[kTouchFaultTick - 1]).norm(), 0.1) << "pressing";
  // The frame of the slow scheduler at the first tick is in time. The next tick has a late sample.
  const std::uint64_t latch = kTouchFaultTick + (bad.frame_every > 1 ? 1 : 0);
  std::uint64_t zero = kTouchNever;
  for (std::uint64_t tick = latch; tick < kTouchResetTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, static_cast<std::uint32_t>(bad.cause)) << tick;
    const double force = test::force_of(rows[tick]).norm();
    if (zero == kTouchNever && force == 0.0) zero = tick;
    if (zero != kTouchNever) {
      ASSERT_EQ(force, 0.0) << tick;
    }
  }
  EXPECT_LE(zero, latch + 10) << "10 ms at 1 kHz";
  double largest_step = 0.0;
  for (std::uint64_t tick = kTouchResetTick; tick < kTouchLastTick; ++tick) {
    ASSERT_EQ(rows[tick].fault, 0U) << tick;
    largest_step =
        std::max(largest_step, (test::force_of(rows[tick]) - test::force_of(rows[tick - 1])).norm());
  }
  EXPECT_LT(largest_step, 0.1) << "N a tick: noise and tissue only, never a jump";
  EXPECT_GT(test::force_of(rows.back()).norm(), 0.05) << "felt again";
  palpate::test::tell({"touch", bad.fault, std::string(bad.injected) + ", while pressing",
                       static_cast<double>(zero - latch), haptics::name_of(bad.cause),
                       "reset, then force again by the ramp", !HasFailure()});
}

INSTANTIATE_TEST_SUITE_P(Arm, TouchSafety, ::testing::ValuesIn(kTouchCases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace palpate::devices
