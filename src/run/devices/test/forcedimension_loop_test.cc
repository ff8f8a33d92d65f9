// The Force Dimension device in the loop, with a stand-in for the vendor's library. Each fault is latched
// with its cause, and the force written to the stand-in is zero within 10 ms of the fault's detection. After
// a reset the force returns without a jump.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "run/devices/forcedimension.h"
#include "run/devices/test/safety_line.h"
#include "run/devices/test/stand_in/dhd_stand_in_loaded.h"
#include "run/realtime/loop.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using stand_in::Loaded;
using testing::HasSubstr;

constexpr double kDhdRate = 1000.0;            // Hz
constexpr std::uint64_t kPressTick = 1000;     // after the soft start: 0.25 s still, 0.5 s of force ramp
constexpr std::uint64_t kDhdFaultTick = 3000;  // the hand is at rest in the tissue
constexpr std::uint64_t kTicks = 3500;
constexpr std::uint64_t kFallTicks = 10;  // 10 ms
constexpr double kHandForce = 1.0;        // N, downwards

double size_of(const double* v) { return Vec3(v[0], v[1], v[2]).norm(); }

double largest_step_of(const std::vector<double>& forces) {
  double largest = 0.0;
  for (std::size_t i = 1; i < forces.size(); ++i) {
    largest = std::max(largest, std::abs(forces[i] - forces[i - 1]));
  }
  return largest;
}

/// Puts a hand of 0.25 kg at rest 1 mm above the block of test_world.h.
void rest(stand_in::Device& hardware) {
  hardware.mass = 0.25;
  hardware.damping = 5.0;
  hardware.position[0] = 0.0;
  hardware.position[1] = 0.0;
  hardware.position[2] = haptics::test::kBallRadius + 1e-3;
  std::fill_n(hardware.velocity, 3, 0.0);
  std::fill_n(hardware.hand_force, 3, 0.0);
}

/// Ends every fault of the stand-in and switches the force on, as its button does.
void heal(stand_in::Device& hardware) {
  hardware.pose_result = hardware.velocity_result = hardware.status_result = hardware.write_result = 0;
  hardware.force_off_cause = 0;
  hardware.powered = true;
  hardware.uncalibrated = false;
  hardware.rotation[2][2] = 1.0;
  hardware.force_on = true;
}

/// Keeps the rows of a run and the stand-in's force after each tick. The hand presses with kHandForce from
/// kPressTick on.
class Hand final : public haptics::TickObserver {
 public:
  using Act = std::function<void(stand_in::Device&)>;
  explicit Hand(stand_in::Device& hardware, Act at_fault = nullptr)
      : hardware_(hardware), at_fault_(std::move(at_fault)) {}
  void on_row(const haptics::TickRow& row) noexcept override {
    if (row.hand != 0) {
      others.push_back(row);
      return;
    }
    rows.push_back(row);
    forces.push_back(size_of(hardware_.force));
    if (row.tick == kPressTick) hardware_.hand_force[2] = -kHandForce;
    if (row.tick == kDhdFaultTick && at_fault_) at_fault_(hardware_);
  }

  std::vector<haptics::TickRow> rows;
  std::vector<haptics::TickRow> others;  // rows of the other hands
  std::vector<double> forces;            // N

 private:
  stand_in::Device& hardware_;
  Act at_fault_;
};

/// A device whose user resets the fault at the first tick.
class AskingForReset final : public haptics::Device {
 public:
  explicit AskingForReset(haptics::Device& device) : device_(device) {}
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    haptics::DeviceState state = device_.read(tick, time);
    if (tick == 0) state.events |= haptics::kResetFault;
    return state;
  }
  bool write(const haptics::ForceCommand& command) noexcept override { return device_.write(command); }
  void stop() noexcept override { device_.stop(); }
  [[nodiscard]] std::uint64_t last_tick(double rate) const noexcept override {
    return device_.last_tick(rate);
  }

 private:
  haptics::Device& device_;
};

/// A world with held devices over the block.
haptics::SimulationWorld held_world(std::size_t hands) {
  haptics::SimulationWorld world = haptics::test::block_and_balls(hands, kDhdRate, haptics::test::no_noise());
  for (haptics::WorkspaceMapping& mapping : world.mappings) mapping.held = true;
  return world;
}

struct FaultCase {
  const char* name;
  const char* injected;
  void (*inject)(stand_in::Device&);
  std::uint64_t seen_within;  // ticks; the status is read every 2 ms, a sample is stale after 5 ms
  Fault recorded;
  const char* words;  // part of last_error(); empty: the device reports no error itself
};

std::ostream& operator<<(std::ostream& out, const FaultCase& fault) { return out << fault.name; }

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const FaultCase kFaults[] = {
    {"PositionUnreadable", "the position cannot be read", [](stand_in::Device& d) { d.pose_result = -1; }, 1,
     Fault::kDevice, "could not be read"},
    {"VelocityUnreadable", "the velocity cannot be read", [](stand_in::Device& d) { d.velocity_result = -1; },
     1, Fault::kDevice, "could not be read"},
    {"StatusUnreadable", "the status cannot be read", [](stand_in::Device& d) { d.status_result = -1; }, 3,
     Fault::kDevice, "status could not be read"},
    {"ForceRefused", "a force is refused", [](stand_in::Device& d) { d.write_result = -1; }, 2,
     Fault::kDevice, "refused a force"},
    {"Stale", "nothing but time-guarded samples", [](stand_in::Device& d) { d.pose_result = 1; }, 7,
     Fault::kStale, ""},
    {"NaNPosition", "NaN as position", [](stand_in::Device& d) { d.position[1] = kNaN; }, 1,
     Fault::kNotFinite, ""},
    {"NaNRotation", "NaN in the rotation", [](stand_in::Device& d) { d.rotation[2][2] = kNaN; }, 1,
     Fault::kNotFinite, ""},
    {"ForceButton", "force off by its button", [](stand_in::Device& d) { d.force_off_cause = 1; }, 3,
     Fault::kForceOff, "force button"},
    {"Velocity", "force off by its velocity limit", [](stand_in::Device& d) { d.force_off_cause = 2; }, 3,
     Fault::kForceOff, "velocity limit"},
    {"Watchdog", "force off by its watchdog", [](stand_in::Device& d) { d.force_off_cause = 3; }, 3,
     Fault::kForceOff, "watchdog"},
    {"Software", "force off by a program", [](stand_in::Device& d) { d.force_off_cause = 4; }, 3,
     Fault::kForceOff, "a program"},
    {"UsbLost", "force off by the loss of USB", [](stand_in::Device& d) { d.force_off_cause = 5; }, 3,
     Fault::kForceOff, "USB"},
    {"DeadMan", "force off by its dead-man switch", [](stand_in::Device& d) { d.force_off_cause = 6; }, 3,
     Fault::kForceOff, "dead-man"},
    {"Power", "power lost", [](stand_in::Device& d) { d.powered = false; }, 3, Fault::kForceOff, "no power"},
    {"Calibration", "put into its reset mode", [](stand_in::Device& d) { d.uncalibrated = true; }, 3,
     Fault::kForceOff, "not calibrated"},
};

class ForceDimensionSafety : public testing::TestWithParam<FaultCase> {
 protected:
  /// Checks all rows from the latched fault on, and the force at the stand-in. @return ticks from the first
  /// bad sample to the first tick without force
  std::uint64_t check_fall(const Hand& hand) const;
  /// Checks that the force returns after the fault has ended and was reset, with the hand outside and still.
  /// The force must not rise in larger steps than at the first contact.
  void check_return(haptics::Device& device, double largest_step);

  Loaded dhd_{stand_in::file_of("dhd_stand_in")};
  stand_in::Device& hardware_ = dhd_.device();
  haptics::SimulationWorld world_ = held_world(1);
  haptics::SimulationState state_{world_};
};

std::uint64_t ForceDimensionSafety::check_fall(const Hand& hand) const {
  const auto latched = std::find_if(hand.rows.begin(), hand.rows.end(),
                                    [](const haptics::TickRow& row) { return row.fault != 0; });
  if (latched == hand.rows.end()) {
    ADD_FAILURE() << "no fault in any row";
    return kTicks;
  }
  EXPECT_GT(latched->tick, kDhdFaultTick);
  EXPECT_LE(latched->tick, kDhdFaultTick + GetParam().seen_within);
  // A device that refuses every force keeps its last one, so the rows show the command that the gate gave.
  const bool refuses = hardware_.write_result < 0;
  const auto force = [&](std::uint64_t tick) {
    return refuses ? size_of(hand.rows[tick].force.data()) : hand.forces[tick];
  };
  std::uint64_t zero = latched->tick;
  while (zero < kTicks && force(zero) != 0.0) ++zero;
  EXPECT_LT(zero, latched->tick + kFallTicks) << "10 ms, the latching tick counted";
  for (std::uint64_t tick = latched->tick; tick < kTicks; ++tick) {
    EXPECT_EQ(hand.rows[tick].fault, static_cast<std::uint32_t>(GetParam().recorded)) << "tick " << tick;
    EXPECT_LE(force(tick), force(tick - 1)) << "tick " << tick;
    if (tick >= zero) {
      EXPECT_EQ(force(tick), 0.0) << "tick " << tick;
    }
  }
  return zero - (kDhdFaultTick + 1);
}

void ForceDimensionSafety::check_return(haptics::Device& device, double largest_step) {
  Hand again(hardware_);
  heal(hardware_);
  rest(hardware_);
  AskingForReset reset(device);
  haptics::Device* const devices[] = {&reset};
  const haptics::LoopReport report =
      realtime::run_loop(world_, state_, devices, {&again}, {.ticks = kTicks, .offline = true});
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(again.forces[0], 0.0);
  EXPECT_NEAR(again.forces.back(), kHandForce, 0.05);
  EXPECT_LE(largest_step_of(again.forces), 1.1 * largest_step) << "no more than at a touch without a fault";
}

TEST_P(ForceDimensionSafety, AFaultTakesTheForceAwayIn10MsAndAResetBringsItBackWithoutAJump) {
  rest(hardware_);
  ForceDimensionDevice device(dhd_.path, 0);
  haptics::Device* const devices[] = {&device};
  Hand hand(hardware_, GetParam().inject);
  const haptics::LoopReport report =
      realtime::run_loop(world_, state_, devices, {&hand}, {.ticks = kTicks, .offline = true});
  ASSERT_EQ(hand.rows.size(), kTicks) << "the run goes on";
  EXPECT_NEAR(hand.forces[kDhdFaultTick], kHandForce, 0.05) << "the tissue carries the hand";
  EXPECT_EQ(report.fault, GetParam().recorded);
  EXPECT_THAT(device.last_error(), HasSubstr(GetParam().words));
  const std::uint64_t ticks_to_zero = check_fall(hand);
  hand.forces.resize(kDhdFaultTick);
  check_return(device, largest_step_of(hand.forces));
  palpate::test::tell(
      {.device = "forcedimension",
       .fault = GetParam().injected,
       .injected = "at the stand-in for the vendor's library, while the tissue carries a hand of 1 N",
       .zero_within_ms = static_cast<double>(ticks_to_zero) / kDhdRate * 1e3,
       .cause = haptics::name_of(GetParam().recorded),
       .recovery = "in order again and reset: engaged outside, then the force of the first touch",
       .survived = !HasFailure()});
}

INSTANTIATE_TEST_SUITE_P(All, ForceDimensionSafety, testing::ValuesIn(kFaults),
                         [](const auto& info) { return std::string(info.param.name); });

class ForceDimensionInTheLoop : public testing::Test {
 protected:
  Loaded dhd_{stand_in::file_of("dhd_stand_in")};
  stand_in::Device& hardware_ = dhd_.device();
};

TEST_F(ForceDimensionInTheLoop, AHandThatPressesRestsWhereTheTissueCarriesIt) {
  const haptics::SimulationWorld world = held_world(1);
  haptics::SimulationState state(world);
  rest(hardware_);
  ForceDimensionDevice device(dhd_.path, 0);
  haptics::Device* const devices[] = {&device};
  Hand hand(hardware_);
  const haptics::LoopReport report =
      realtime::run_loop(world, state, devices, {&hand}, {.ticks = 2 * kTicks, .offline = true});
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_NEAR(hand.rows.back().force[2], kHandForce, 1e-3);
  EXPECT_GT(hand.rows.back().depth, 0.0);
  EXPECT_EQ(size_of(hardware_.force), 0.0) << "stopped at the end";
}

TEST_F(ForceDimensionInTheLoop, AForceThatIsStillOffAtTheResetLatchesAgainAtOnce) {
  const haptics::SimulationWorld world = held_world(1);
  haptics::SimulationState state(world);
  rest(hardware_);
  ForceDimensionDevice device(dhd_.path, 0);
  AskingForReset reset(device);
  haptics::Device* const devices[] = {&reset};
  hardware_.force_off_cause = 6;
  Hand hand(hardware_);
  (void)realtime::run_loop(world, state, devices, {&hand}, {.ticks = 10, .offline = true});
  EXPECT_EQ(hand.rows.front().fault, static_cast<std::uint32_t>(Fault::kForceOff));
  EXPECT_EQ(hand.rows.back().fault, static_cast<std::uint32_t>(Fault::kForceOff));
  EXPECT_THAT(hand.forces, testing::Each(0.0));
}

TEST_F(ForceDimensionInTheLoop, TwoDevicesAreTwoHandsAndAFaultOfOneLeavesTheOther) {
  dhd_.library->count = 2;
  rest(dhd_.device(0));
  rest(dhd_.device(1));
  dhd_.device(1).position[0] = 0.02;
  const haptics::SimulationWorld world = held_world(2);
  haptics::SimulationState state(world);
  ForceDimensionDevice left(dhd_.path, 0);
  ForceDimensionDevice right(dhd_.path, 1);
  haptics::Device* const devices[] = {&left, &right};
  Hand hand(hardware_, [this](stand_in::Device& d) {
    d.pose_result = -1;
    dhd_.device(1).hand_force[2] = -kHandForce;
  });
  (void)realtime::run_loop(world, state, devices, {&hand}, {.ticks = 2 * kTicks, .offline = true});
  EXPECT_EQ(hand.rows.back().fault, static_cast<std::uint32_t>(Fault::kDevice));
  EXPECT_EQ(hand.rows.back().force[2], 0.0);
  EXPECT_EQ(hand.others.back().fault, 0U);
  EXPECT_NEAR(hand.others.back().force[2], kHandForce, 0.05);
}

}  // namespace
}  // namespace palpate::devices
