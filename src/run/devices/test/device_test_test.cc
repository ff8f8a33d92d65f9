#include "run/devices/device_test.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run/devices/emulated.h"

namespace palpate::devices {
namespace {

using realtime::HeldPlay;
using realtime::PlayClock;
using realtime::PlayLimits;
using testing::HasSubstr;

constexpr double kTestedRate = 1000.0;

/// A clock that jumps to each deadline, and is late at every second one.
struct JumpingClock {
  std::shared_ptr<std::int64_t> now = std::make_shared<std::int64_t>(0);
  std::shared_ptr<std::uint64_t> sleeps = std::make_shared<std::uint64_t>(0);
  std::int64_t late_ns = 0;

  [[nodiscard]] PlayClock clock() const {
    return {[now = now] { return *now; },
            [*this](std::int64_t deadline) { *now = deadline + (++*sleeps % 2 == 0 ? late_ns : 0); }, false};
  }
};

/// An emulated device whose forces act some ticks later.
class Delayed final : public haptics::Device {
 public:
  Delayed(const scene::DeviceSetup& setup, std::size_t ticks)
      : device_(scene::ToolPath({{0.0, Vec3(0.1, 0.02, 0.03), Quat::Identity(), 0.0}}), setup, kTestedRate),
        waiting_(ticks) {}
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override {
    haptics::DeviceState sample = device_.read(tick, time);
    if (time > velocity_fails) sample.velocity_D.x() = std::nan("");
    return sample;
  }
  bool write(const haptics::ForceCommand& command) noexcept override {
    largest = std::max(largest, command.force.norm());
    last = command.force;
    waiting_.push_back(command);
    const bool taken = device_.write(waiting_.front());
    waiting_.pop_front();
    return taken;
  }
  void stop() noexcept override {
    device_.stop();
    ++stops;
  }

  double velocity_fails = std::numeric_limits<double>::infinity();  // s
  double largest = 0.0;                                             // N
  Vec3 last = Vec3::Zero();
  int stops = 0;

 private:
  EmulatedDevice device_;
  std::deque<haptics::ForceCommand> waiting_;
};

scene::DeviceSetup tested_setup(double friction, double resolution) {
  scene::DeviceSetup setup;
  setup.kind = "emulated";
  setup.dynamics.friction = friction;
  setup.dynamics.resolution = resolution;
  return setup;
}

DeviceTest test_of(Delayed& device, const DeviceTestSettings& settings = {}, const JumpingClock& clock = {}) {
  HeldPlay play(device, kTestedRate, PlayLimits{}, clock.clock());
  return test_device(play, settings, [](const std::string&, const std::string&) { return true; });
}

/// The series of exp(A / 2^16), squared 16 times. Eigen's own takes seconds to compile.
Eigen::Matrix3d exponential(const Eigen::Matrix3d& matrix) {
  constexpr int kSquarings = 16;
  const Eigen::Matrix3d part = std::ldexp(1.0, -kSquarings) * matrix;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity() + part + 0.5 * part * part;
  for (int i = 0; i < kSquarings; ++i) sum = (sum * sum).eval();
  return sum;
}

/// The stiffness at which the sampled loop of wall, mass, damping and grip becomes unstable: the largest
/// eigenvalue of one exact period with the wall's force held reaches 1.
double critical_stiffness(double mass, double damping, double grip, double period) {
  const auto radius = [&](double wall) {
    Eigen::Matrix3d rates = Eigen::Matrix3d::Zero();  // of x, v and the held x
    rates << 0, 1, 0, -grip / mass, -damping / mass, -wall / mass, 0, 0, 0;
    const Eigen::Matrix3d step = exponential(rates * period);
    Eigen::Matrix2d loop = step.topLeftCorner<2, 2>();
    loop.col(0) += step.block<2, 1>(0, 2);
    const double mean = 0.5 * loop.trace();
    const double square = mean * mean - loop.determinant();
    return square < 0.0 ? std::sqrt(loop.determinant()) : std::abs(mean) + std::sqrt(square);
  };
  double low = 100.0, high = 1e6;
  while (high - low > 1.0) (radius(0.5 * (low + high)) < 1.0 ? low : high) = 0.5 * (low + high);
  return low;
}

TEST(DeviceTest, RecoversFrictionResolutionAndLatencyOfAnEmulatedDevice) {
  for (const double friction : {0.02, 0.05, 0.15}) {
    for (const std::size_t delay : {0U, 3U}) {
      for (const double resolution : {1e-5, 3e-5}) {
        Delayed device(tested_setup(friction, resolution), delay);
        DeviceTestSettings settings;
        settings.max_stiffness = settings.least_stiffness;
        const DeviceTest found = test_of(device, settings);
        ASSERT_TRUE(found.friction && found.resolution && found.latency) << found.failure;
        EXPECT_NEAR(found.friction->mean, friction, 0.05 * friction + 0.001);
        EXPECT_NEAR(*found.resolution, resolution, 1e-9);
        const double bound = 0.1e-3 + 20.0 * resolution;  // s: 0.3 ms at 0.01 mm
        EXPECT_NEAR(found.latency->mean, static_cast<double>(delay) / kTestedRate, bound)
            << friction << ' ' << resolution;
      }
    }
  }
}

TEST(DeviceTest, RecoversTheMovingMass) {
  Delayed device(tested_setup(0.0, 1e-6), 0);
  DeviceTestSettings settings;
  settings.max_stiffness = settings.least_stiffness;
  const DeviceTest found = test_of(device, settings);
  ASSERT_TRUE(found.mass.has_value());
  EXPECT_NEAR(found.mass->mean, 0.25, 0.02 * 0.25);
}

TEST(DeviceTest, FindsTheStiffnessAtWhichTheSampledLoopBecomesUnstable) {
  for (const double damping : {0.5, 1.5}) {
    scene::DeviceSetup setup = tested_setup(0.0, 1e-6);
    setup.dynamics.damping = damping;
    setup.emulated.grip = scene::kLightGrip;
    Delayed device(setup, 0);
    const DeviceTest found = test_of(device);
    const double critical = critical_stiffness(setup.emulated.mass, damping + scene::kLightGrip.damping,
                                               scene::kLightGrip.stiffness, 1.0 / kTestedRate);
    ASSERT_TRUE(found.largest_stable && found.least_oscillating) << found.failure;
    EXPECT_NEAR(*found.largest_stable / critical, 1.0, 0.08) << critical;
    EXPECT_LT(*found.least_oscillating / *found.largest_stable, 1.05);
  }
}

TEST(DeviceTest, NoForceExceedsTheLimitAndTheLastOneIsZero) {
  Delayed device(tested_setup(0.0, 1e-6), 5);  // oscillates early
  HeldPlay play(device, kTestedRate, PlayLimits{.max_force = 1.2}, JumpingClock{}.clock());
  const DeviceTest found = test_device(play, {}, [](const std::string&, const std::string&) { return true; });
  EXPECT_LE(device.largest, 1.2);
  EXPECT_EQ(device.last, Vec3::Zero());
  EXPECT_TRUE(found.least_oscillating || !found.failure.empty());
}

TEST(DeviceTest, AFaultEndsTheTestAtZeroForceWithASentence) {
  scene::DeviceSetup setup = tested_setup(0.05, 1e-5);
  setup.emulated.faults.push_back({scene::EmulatedFaultKind::kForceOff, 8.0, 0.0});
  Delayed device(setup, 0);
  const DeviceTest found = test_of(device);
  EXPECT_THAT(found.failure, HasSubstr("the force is zero, and the measurement ended"));
  EXPECT_FALSE(found.friction);
  EXPECT_EQ(device.last, Vec3::Zero());
  EXPECT_GE(device.stops, 1);
}

TEST(DeviceTest, AVelocityThatIsNoNumberEndsTheTestAtZeroForce) {
  Delayed device(tested_setup(0.05, 1e-5), 0);
  device.velocity_fails = 8.0;
  const DeviceTest found = test_of(device);
  EXPECT_THAT(found.failure, HasSubstr("the force is zero, and the measurement ended"));
  EXPECT_EQ(device.last, Vec3::Zero());
}

TEST(DeviceTest, ARunawayEndsTheTestAtZeroForceWithASentence) {
  scene::DeviceSetup setup = tested_setup(0.0, 1e-5);
  setup.emulated.grip = {0.0, 0.1};  // nobody holds it
  Delayed device(setup, 0);
  const DeviceTest found = test_of(device);
  EXPECT_THAT(found.failure, HasSubstr("hold it more firmly"));
  EXPECT_EQ(device.last, Vec3::Zero());
}

TEST(DeviceTest, ReportsTheJitterOfTheLoop) {
  Delayed device(tested_setup(0.05, 1e-5), 0);
  JumpingClock clock;
  clock.late_ns = 100'000;  // periods of 0.9 and 1.1 ms in turn
  DeviceTestSettings settings;
  settings.max_stiffness = settings.least_stiffness;
  const DeviceTest found = test_of(device, settings, clock);
  EXPECT_NEAR(found.loop_rate, kTestedRate, 0.1);
  EXPECT_NEAR(found.sample_rate, kTestedRate, 0.1);
  EXPECT_NEAR(found.jitter_sd, 100e-6, 1e-6);
  EXPECT_NEAR(found.longest_period, 1.1e-3, 1e-6);
}

TEST(DeviceTest, SaysThatAPositionWithoutStepsHasNoResolution) {
  Delayed device(tested_setup(0.05, 0.0), 0);
  DeviceTestSettings settings;
  settings.max_stiffness = settings.least_stiffness;
  const DeviceTest found = test_of(device, settings);
  EXPECT_FALSE(found.resolution);
  EXPECT_THAT(found.unknown, testing::Contains(HasSubstr("position resolution")));
}

}  // namespace
}  // namespace palpate::devices
