// Random and adversarial device samples through tick and gate. PALPATE_SAMPLES sets their number (CI: 10^7).
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/haptics/prepared_update.h"
#include "core/haptics/test/test_world.h"
#include "palpate/parameter_updates.h"

namespace palpate::realtime {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr long kSamplesByDefault = 50'000;  // a sanitizer makes each sample several times slower
#else
constexpr long kSamplesByDefault = 500'000;
#endif

long samples_wanted() {
  const char* text = std::getenv("PALPATE_SAMPLES");  // NOLINT(concurrency-mt-unsafe): no other thread yet
  return text != nullptr ? std::strtol(text, nullptr, 10) : kSamplesByDefault;
}

/// A sample that no hand can produce. It jumps in and out of the block, and often has a value that is not
/// finite or that no device would report.
haptics::DeviceState adversarial(std::mt19937_64& random) {
  static constexpr double kOdd[] = {kNaN, kInf, -kInf, 1e308, -1e308, 1e30, 5e-324, 1e-310, 0.0, -0.0};
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  haptics::DeviceState sample;
  sample.position_D = 0.03 * Vec3(unit(random), unit(random), unit(random));
  sample.orientation_D = Quat(unit(random), unit(random), unit(random), unit(random)).normalized();
  sample.velocity_D = Vec3(unit(random), unit(random), unit(random));
  sample.gripper = unit(random);
  const std::uint64_t dice = random();
  sample.buttons = static_cast<std::uint32_t>(dice >> 40U) & 3U;
  if (dice % 32 != 0) return sample;
  const double odd = kOdd[(dice >> 8U) % std::size(kOdd)];
  double* const places[] = {&sample.position_D.x(),
                            &sample.position_D.z(),
                            &sample.velocity_D.y(),
                            &sample.orientation_D.w(),
                            &sample.gripper,
                            &sample.orientation_D.x(),
                            &sample.age};
  *places[(dice >> 16U) % std::size(places)] = odd;
  static constexpr haptics::Fault kFaults[] = {haptics::Fault::kNone, haptics::Fault::kNone,
                                               haptics::Fault::kDevice, haptics::Fault::kStalled,
                                               haptics::Fault::kForceOff};
  sample.fault = kFaults[(dice >> 24U) % std::size(kFaults)];
  return sample;
}

bool all_numbers_finite(const haptics::TickRow& row) {
  for (const auto* three : {&row.force, &row.torque, &row.tool, &row.contact, &row.normal}) {
    for (const double x : *three) {
      if (!std::isfinite(x)) return false;
    }
  }
  for (const double x : row.tool_q) {
    if (!std::isfinite(x)) return false;
  }
  return std::isfinite(row.distance) && std::isfinite(row.depth) && std::isfinite(row.tissue_force) &&
         std::isfinite(row.noise_force) && std::isfinite(row.friction) && std::isfinite(row.gripper_force) &&
         std::isfinite(row.gripper) && std::isfinite(row.energy) && row.engagement >= 0.0 &&
         row.engagement <= 1.0;
}

/// Checks every tick against the gate's limits. Only a fault may reduce the force faster than the slew limit.
class LimitsKept final {
 public:
  explicit LimitsKept(const haptics::GateLimits& limits) : limits_(limits) {}

  [[nodiscard]] ::testing::AssertionResult check(const haptics::TickRow& row,
                                                 const haptics::ForceCommand& command) {
    const auto failed = [](const char* what) { return ::testing::AssertionFailure() << what; };
    if (!all_numbers_finite(row)) return failed("a number in the row is not finite");
    if (!command.force.allFinite() || !command.torque.allFinite()) return failed("the command is not finite");
    if (command.force.norm() > limits_.max_force) return failed("force over its limit");
    if (command.torque.norm() > limits_.max_torque) return failed("torque over its limit");
    if (row.fault == 0) {
      const double over = 1 + 1e-12;
      if ((command.force - last_.force).norm() > limits_.force_step * over) return failed("force slew");
      if ((command.torque - last_.torque).norm() > limits_.torque_step * over) return failed("torque slew");
    } else if (command.force.norm() > last_.force.norm() || command.torque.norm() > last_.torque.norm()) {
      return failed("a fault let the force rise");
    }
    last_ = command;
    return ::testing::AssertionSuccess();
  }

 private:
  haptics::GateLimits limits_;
  haptics::ForceCommand last_;
};

/// Changes the tissue during the run: either spring law, up to three Prony terms.
void change_tissue(const haptics::SimulationWorld& world, haptics::SimulationState& state,
                   std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  static constexpr const char* kNames[] = {"gallbladder", "heart", "liver", "kidney"};
  model::TissueParameters tissue = model::tissue_preset(kNames[random() % std::size(kNames)]);
  tissue.k1 *= 0.2 + 2.0 * unit(random);
  if (random() % 2 == 0) tissue.law = model::LawKind::kSmooth;
  for (std::uint64_t terms = random() % 4; terms > 0; --terms) {
    tissue.relaxation.push_back({0.33 * unit(random) + 1e-6, 1e-3 + unit(random)});
  }
  const haptics::LiveNoise noise{random() % 2 == 0, 1e-4 * unit(random), 1e-3 + 1e-2 * unit(random)};
  haptics::apply_update(
      world, state,
      haptics::prepare_update(
          world, haptics::parameter_update(tissue, noise, haptics::kTissueChanged | haptics::kNoiseChanged)));
}

/// @param changes whether tissue and noise change every 150 samples
void run_samples(bool held, long count, std::uint64_t seed, bool changes = false) {
  haptics::SimulationWorld world = haptics::test::block_and_balls(1, 1000.0);
  world.mappings[0].held = held;
  haptics::SimulationState state(world);
  LimitsKept limits(world.limits);
  std::mt19937_64 random(seed);
  haptics::ForceCommand command;
  haptics::TickRow row;
  std::uint64_t in_contact = 0;
  for (long i = 0; i < count; ++i) {
    // Hand-like motion ends the soft start and forms contacts that last. A burst of
    // impossible samples follows.
    haptics::DeviceState sample;
    const long phase = i % 2000;
    if (phase < 1900) {
      sample.position_D.z() =
          phase < 900 ? 0.008 : 0.003 + 0.008 * std::sin(0.02 * static_cast<double>(phase));
    } else {
      sample = adversarial(random);
    }
    if (phase == 0) sample.events = haptics::kResetFault;
    if (changes && i % 150 == 0) change_tissue(world, state, random);
    haptics::tick(world, state, static_cast<std::uint64_t>(i), {&sample, 1}, {&command, 1}, {&row, 1});
    ASSERT_TRUE(limits.check(row, command)) << "sample " << i;
    if (row.phase != 0 && command.force.norm() > 0.02) ++in_contact;
  }
  EXPECT_GT(in_contact, static_cast<std::uint64_t>(count / 20)) << "the samples must reach the tissue";
}

TEST(Adversarial, SamplesOfAScriptedDeviceNeverBreakTheGate) { run_samples(false, samples_wanted() / 2, 3); }

TEST(Adversarial, SamplesOfAHeldDeviceNeverBreakTheGate) { run_samples(true, samples_wanted() / 2, 4); }

TEST(Adversarial, TissuesThatRelaxAndChangeWhileTheyAreTouchedNeverBreakTheGate) {
  run_samples(false, samples_wanted() / 5, 6, true);
  run_samples(true, samples_wanted() / 5, 7, true);
}

TEST(Adversarial, NothingButNonsenseNeverBreaksTheGate) {
  haptics::SimulationWorld world = haptics::test::block_and_balls(1, 4000.0);
  world.mappings[0].clutch = 1U;
  haptics::SimulationState state(world);
  LimitsKept limits(world.limits);
  std::mt19937_64 random(5);
  haptics::ForceCommand command;
  haptics::TickRow row;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    haptics::DeviceState sample = adversarial(random);
    sample.events = i % 50 == 0 ? haptics::kResetFault : 0U;
    haptics::tick(world, state, i, {&sample, 1}, {&command, 1}, {&row, 1});
    ASSERT_TRUE(limits.check(row, command)) << "sample " << i;
  }
}

}  // namespace
}  // namespace palpate::realtime
