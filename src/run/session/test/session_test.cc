#include "palpate/session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "run/devices/test/emulated_scene.h"
#include "run/session/statistics_observer.h"

namespace palpate::session {
namespace {

using haptics::DeviceState;

/// A ball over a block, moved by a scripted device.
scene::Scene block() {
  scene::Scene scene = devices::test::block_and_hand();
  scene.devices[0].kind = "scripted";
  return scene;
}

/// Presses down from 5 mm above the block, without end. The sample of tick `fault_at` is unreadable.
class Presser final : public haptics::Device {
 public:
  explicit Presser(std::uint64_t fault_at = std::numeric_limits<std::uint64_t>::max())
      : fault_at_(fault_at) {}
  DeviceState read(std::uint64_t tick, double time) noexcept override {
    DeviceState state;
    state.position_D = Vec3(0.001, 0.002, devices::test::kBallRadius + std::max(-0.005, 0.005 - 0.1 * time));
    if (tick == fault_at_) state.fault = haptics::Fault::kDevice;
    return state;
  }
  bool write(const haptics::ForceCommand& /*command*/) noexcept override { return true; }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double /*rate_Hz*/) const noexcept override {
    return std::numeric_limits<std::uint64_t>::max();
  }

 private:
  std::uint64_t fault_at_;
};

/// A Presser with given abilities, which keeps the largest commanded force.
class WeakArm final : public haptics::Device {
 public:
  explicit WeakArm(const haptics::DeviceAbilities& abilities) : abilities_(abilities) {}
  DeviceState read(std::uint64_t tick, double time) noexcept override { return presser_.read(tick, time); }
  bool write(const haptics::ForceCommand& command) noexcept override {
    most = std::max(most, command.force.norm());
    return true;
  }
  void stop() noexcept override {}
  [[nodiscard]] std::uint64_t last_tick(double rate_Hz) const noexcept override {
    return presser_.last_tick(rate_Hz);
  }
  [[nodiscard]] haptics::DeviceAbilities abilities() const override { return abilities_; }

  double most = 0.0;  // N

 private:
  Presser presser_;
  haptics::DeviceAbilities abilities_;
};

SessionOptions with(std::unique_ptr<haptics::Device> device, std::optional<double> duration_s) {
  SessionOptions options;
  options.devices.push_back(std::move(device));
  options.duration_s = duration_s;
  return options;
}

class Counter final : public haptics::TickObserver {
 public:
  void on_start(std::int64_t /*started_unix_ns*/) noexcept override { ++starts; }
  void on_row(const haptics::TickRow& /*row*/) noexcept override { ++rows; }
  void on_tick(const haptics::TickState& /*now*/) noexcept override { ++ticks; }
  int starts = 0;
  int rows = 0;
  std::atomic<int> ticks{0};
};

TEST(Session, RecordsAPressInOneExpressionAndItReplaysBitForBit) {
  const test::TemporaryFolder folder;
  const RunResult result = Session::open(block()).run({.recording = folder / "press.h5", .offline = true});
  EXPECT_GT(result.statistics.peak_depth, 1e-3);
  const record::Recording recording = record::read_recording(folder / "press.h5");
  EXPECT_TRUE(recording.facts.complete);
  EXPECT_EQ(recording.rows.size(), result.loop.ticks);
  EXPECT_EQ(record::replay(recording).first_difference, "");
}

TEST(Session, TheRecordingOfAStudyIsBlindAndReplaysWithItsTimedForces) {
  const test::TemporaryFolder folder;
  Session session(block());
  (void)session.updates().offer(haptics::LiveStimulus{0.02, 20e-3, 1}, 120);
  (void)session.updates().offer(haptics::LiveStimulus{0.0, 20e-3, 0}, 320);
  (void)session.run({.recording = folder / "b.h5", .offline = true, .study = {"pilot", "commitment"}});
  EXPECT_THROW((void)record::read_recording(folder / "b.h5"), InputError);
  const record::Recording recording = record::read_recording(folder / "b.h5", {}, record::Blind::kAllow);
  EXPECT_EQ(recording.facts.study, (record::StudyMark{"pilot", "commitment"}));
  EXPECT_EQ(recording.rows[319].stimulus_force, 0.02);
  EXPECT_EQ(record::replay(recording).rows_different, 0U);
}

haptics::DeviceAbilities weak_abilities() {
  haptics::DeviceAbilities abilities;
  abilities.model = "Weak Arm";
  abilities.max_force = 0.05;
  abilities.max_stiffness = 4.5;
  abilities.torque = false;
  return abilities;
}

TEST(Session, TheLimitsFollowADeviceThatBearsLessThanTheSceneAsksForAndTheUserHearsIt) {
  const test::TemporaryFolder folder;
  auto arm = std::make_unique<WeakArm>(weak_abilities());
  const WeakArm& felt = *arm;
  scene::Scene scene = block();
  scene.noise.enabled = false;
  scene.noise.gain = 0.0;
  Session session(scene, with(std::move(arm), 0.5));
  const RunResult result = session.run({.recording = folder / "weak.h5", .offline = true});
  EXPECT_NEAR(felt.most, 0.05, 1e-12);
  EXPECT_THAT(result.scene_remarks,
              testing::Contains(
                  testing::HasSubstr("max_force_N = 20 is lowered to 0.05, the most that a Weak Arm gives")));
  const record::Recording recording = record::read_recording(folder / "weak.h5");
  EXPECT_EQ(recording.scene.safety.max_force, 0.05);
  EXPECT_EQ(recording.scene.devices[0].abilities.torque, false);
  EXPECT_EQ(recording.scene.devices[0].abilities.max_stiffness, 4.5);
  EXPECT_EQ(record::replay(recording).first_difference, "");
}

TEST(Session, TheUserHearsThatAnOrganIsTooThinForTheDefaultPath) {
  scene::Scene scene = block();
  scene.organ = geometry::make_box({100e-3, 100e-3, 5e-3}, 10e-3);
  const RunResult result = Session(scene).run({.offline = true});
  EXPECT_THAT(result.scene_remarks, testing::Contains(testing::HasSubstr("the organ is 5 mm thick where")));
}

TEST(Session, TheUserHearsThatVisibleInclusionsOverlapAndNothingOfHiddenOnes) {
  const auto mentions_overlap = [](bool visible) {
    scene::Scene scene = block();
    scene.inclusions = {{"left", true, {Vec3(0, 0, -10e-3), 4e-3, 2.0}},
                        {"right", visible, {Vec3(5e-3, 0, -10e-3), 4e-3, 2.0}}};
    const RunResult result = Session(scene).run({.offline = true});
    return std::any_of(result.scene_remarks.begin(), result.scene_remarks.end(),
                       [](const std::string& remark) { return remark.find("right") != std::string::npos; });
  };
  EXPECT_TRUE(mentions_overlap(true));
  EXPECT_FALSE(mentions_overlap(false));
}

TEST(Session, AFittedDeviceFeelsTheTissueNoStifferThanItBears) {
  const test::TemporaryFolder folder;
  haptics::DeviceAbilities abilities = weak_abilities();
  abilities.max_force = 20.0;
  const auto most_force = [&](bool fit, const std::filesystem::path& file) {
    auto arm = std::make_unique<WeakArm>(abilities);
    const WeakArm& felt = *arm;
    scene::Scene scene = block();
    scene.noise.enabled = false;
    scene.devices[0].fit = fit;
    Session session(scene, with(std::move(arm), 0.5));
    const RunResult result = session.run({.recording = file, .offline = true});
    EXPECT_EQ(std::any_of(
                  result.scene_remarks.begin(), result.scene_remarks.end(),
                  [](const std::string& remark) { return remark.find("is scaled by") != std::string::npos; }),
              fit);
    return felt.most;
  };
  const double whole = most_force(false, folder / "whole.h5");
  const double fitted = most_force(true, folder / "fitted.h5");
  const record::Recording recording = record::read_recording(folder / "fitted.h5");
  const double scale = recording.scene.devices[0].force_scale;
  EXPECT_LT(scale, 0.1) << "the tissue's tangent within reach is far above 4.5 N/m";
  EXPECT_NEAR(fitted / whole, scale, 1e-9);
  EXPECT_EQ(record::replay(recording).first_difference, "");
}

TEST(Session, RunsTheTicksOfItsDurationAndTellsObserversOfEachOnce) {
  Session session(block(), with(std::make_unique<Presser>(), 0.3));
  Counter counter;
  const RunResult result = session.run({.offline = true}, {&counter});
  EXPECT_EQ(result.loop.ticks, 300U);
  EXPECT_EQ(counter.starts, 1);
  EXPECT_EQ(counter.rows, 300);
  EXPECT_EQ(counter.ticks, 300);
  EXPECT_EQ(result.scene, "block");
  EXPECT_EQ(result.hands, 1U);
  EXPECT_TRUE(result.offline);
}

TEST(Session, StatisticsArePeaksAndPhasesOfTheRows) {
  const test::TemporaryFolder folder;
  Session session(block(), with(std::make_unique<Presser>(), 0.3));
  const RunStatistics seen = session.run({.recording = folder / "a.h5", .offline = true}).statistics;
  double force = 0.0;
  double depth = 0.0;
  std::uint64_t touching = 0;
  std::uint64_t first = 0;
  for (const haptics::TickRow& row : record::read_recording(folder / "a.h5").rows) {
    force = std::max(force, row.tissue_force);
    depth = std::max(depth, row.depth);
    if (row.phase != 0 && touching++ == 0) first = row.tick;
  }
  EXPECT_EQ(seen.peak_tissue, force);
  EXPECT_EQ(seen.peak_depth, depth);
  EXPECT_EQ(seen.contact_ticks, touching);
  ASSERT_EQ(seen.phases.size(), 2U);
  EXPECT_EQ(seen.phases[1].from, static_cast<double>(first) / 1000.0);
  EXPECT_NEAR(seen.phases[1].to, 0.3, 1e-12);
}

/// A spring of 100 N/m is pressed 10 mm in 10 ticks, and released in 10 ticks with half of its force.
TEST(StatisticsObserver, LoadingWorkIsWhatWasPutInAndDissipatedWhatDidNotComeBack) {
  StatisticsObserver observer(block());
  haptics::TickRow row;
  for (int i = 0; i <= 20; ++i) {
    const double depth = 1e-3 * (i <= 10 ? i : 20 - i);
    row.tick = static_cast<std::uint64_t>(i);
    row.depth = depth;
    row.tissue_force = i <= 10 ? 100.0 * depth : 50.0 * depth;
    row.force = {0.0, 0.0, row.tissue_force};
    row.tool = {0.0, 0.0, -depth};
    observer.on_row(row);
  }
  const RunStatistics& seen = observer.statistics();
  EXPECT_NEAR(seen.loading_work, 0.5 * 100.0 * 0.01 * 0.01, 1e-12);
  // The release returns half of the work, and 0.5 * 0.5 N * 1 mm more. The force falls to its half only
  // within the first tick of the release, and this is the area between the two lines.
  EXPECT_NEAR(seen.dissipated, 0.25 * 100.0 * 0.01 * 0.01 - 0.5 * 0.5 * 1e-3, 1e-12);
  EXPECT_NEAR(seen.fastest_rise, 100.0, 1e-9);  // 0.1 N in 1 ms
  EXPECT_EQ(seen.depth_at_peak, 0.01);
}

TEST(Session, RefusesADurationThatIsNoneAndNamesIt) {
  for (const double duration_s : {0.0, -1.0, 1e12, std::nan("")}) {
    EXPECT_THROW(Session(block(), with(std::make_unique<Presser>(), duration_s)), ParameterError)
        << duration_s;
  }
  try {
    (void)ticks_in(0.0, 1000.0, "--duration-s");
    ADD_FAILURE();
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.field(), "--duration-s");
  }
}

TEST(Session, RefusesMoreDevicesThanHands) {
  SessionOptions options = with(std::make_unique<Presser>(), 0.1);
  options.devices.push_back(std::make_unique<Presser>());
  EXPECT_THROW(Session(block(), std::move(options)), std::invalid_argument);
}

TEST(Session, RunsOnce) {
  Session session(block(), with(std::make_unique<Presser>(), 0.01));
  (void)session.run({.offline = true});
  EXPECT_THROW((void)session.run({.offline = true}), std::logic_error);
}

TEST(Session, CanRunAfterARecordingThatCouldNotBeMade) {
  const test::TemporaryFolder folder;
  Session session(block(), with(std::make_unique<Presser>(), 0.01));
  EXPECT_THROW((void)session.run({.recording = folder / "none" / "a.h5", .offline = true}), InputError);
  EXPECT_EQ(session.run({.offline = true}).loop.ticks, 10U);
}

TEST(Session, AFaultIsInTheResultWithoutAFileWhereNoneIsWanted) {
  Session session(block(), with(std::make_unique<Presser>(20), 0.1));
  const RunResult result = session.run({.offline = true, .keep_fault = false});
  EXPECT_EQ(result.loop.fault, haptics::Fault::kDevice);
  EXPECT_TRUE(result.fault_recording.empty());
}

TEST(Session, AParameterUpdateIsUsedAndCounted) {
  Session session(block(), with(std::make_unique<Presser>(), 0.1));
  model::TissueParameters tissue = session.scene().tissue;
  tissue.k1 *= 2.0;
  (void)session.updates().offer(tissue);
  EXPECT_EQ(session.run({.offline = true}).statistics.changes, 1U);
}

TEST(BackgroundRun, GoesOnUntilItIsStopped) {
  Session session(block(), with(std::make_unique<Presser>(), std::nullopt));
  Counter counter;
  const auto run = session.run_in_background({}, {&counter});
  while (counter.ticks < 5) EXPECT_FALSE(run->wait_for(std::chrono::milliseconds(1)));
  run->stop();
  run->wait();
  EXPECT_TRUE(run->ended());
  EXPECT_EQ(run->failure(), "");
  ASSERT_TRUE(run->result());
  EXPECT_TRUE(run->result()->loop.stopped_early);
  EXPECT_EQ(run->result()->loop.ticks, static_cast<std::uint64_t>(counter.ticks));
}

TEST(BackgroundRun, EndsWhenItIsGone) {
  Session session(block(), with(std::make_unique<Presser>(), std::nullopt));
  { const auto run = session.run_in_background(); }
  EXPECT_TRUE(session.control().stopping());
}

TEST(BackgroundRun, SaysWhyItFailed) {
  const test::TemporaryFolder folder;
  Session session(block(), with(std::make_unique<Presser>(), 0.1));
  const auto run = session.run_in_background({.recording = folder / "none" / "a.h5"});
  run->wait();
  EXPECT_FALSE(run->result());
  EXPECT_THAT(run->failure(), testing::HasSubstr("a.h5"));
}

TEST(BackgroundRun, SaysThatItFailedByAnExceptionOfAnyType) {
  Session session(block(), with(std::make_unique<Presser>(), 0.1));
  BackgroundRun run(session.control(), []() -> RunResult { throw 42; });
  run.wait();
  EXPECT_FALSE(run.result());
  EXPECT_EQ(run.failure(), "an exception that is none of the standard library's");
}

}  // namespace
}  // namespace palpate::session
