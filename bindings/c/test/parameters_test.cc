// Live changes of the tissue and the touch noise through the C interface.
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/haptics/simulation.h"
#include "io/scene/make_world.h"
#include "palpate/parameter_updates.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"
#include "palpate/tick_observer.h"
#include "palpate/tool_path.h"
#include "run/realtime/loop.h"

#include "bindings/c/test/c_session.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kTouched = 1400;  // the tool is in the gallbladder
constexpr std::uint64_t kEnd = 2400;

double value_of(const Session& session, const char* field) {
  double value = 0.0;
  require(palpate_get_tissue_value(session.get(), field, &value));
  return value;
}

/// Keeps the rows of a run.
class Rows final : public haptics::TickObserver {
 public:
  explicit Rows(std::size_t ticks) { rows.reserve(ticks); }
  void on_row(const haptics::TickRow& row) noexcept override { rows.push_back(row); }
  std::vector<haptics::TickRow> rows;
};

/// Rows of the built-in press by the program's loop, with updates at kTouched, + 300 and + 600.
std::vector<haptics::TickRow> rows_of_the_loop() {
  const scene::Scene scene = scene::load({});
  const haptics::SimulationWorld world = scene::make_world(scene);
  haptics::SimulationState state(world);
  haptics::ParameterUpdates updates(world, scene.tissue, {});
  model::TissueParameters liver = model::tissue_preset("liver");
  (void)updates.offer(liver, kTouched);
  liver.rest_length = 10.25e-3;
  (void)updates.offer(liver, kTouched + 300);
  (void)updates.offer(haptics::LiveNoise{true, 2e-5, 4e-3}, kTouched + 600);
  devices::ScriptedDevice device(scene::default_path(scene, 0));
  haptics::Device* const devices[] = {&device};
  haptics::RunControl control(&updates);
  Rows rows(kEnd);
  (void)realtime::run_loop(world, state, devices, {&rows},
                           {.ticks = kEnd, .offline = true, .control = &control});
  return rows.rows;
}

TEST(Parameters, ChangedAtGivenTicksGiveTheRowsOfTheLoopsParameterUpdates) {
  const std::vector<haptics::TickRow> expected = rows_of_the_loop();
  ASSERT_EQ(expected.size(), kEnd);
  Session session(unheld());
  for (std::uint64_t tick = 0; tick < kEnd; ++tick) {
    if (tick == kTouched) require(palpate_set_tissue(session.get(), "liver"));
    if (tick == kTouched + 300) require(palpate_set_tissue_value(session.get(), "rest_length_mm", 10.25));
    if (tick == kTouched + 600) require(palpate_set_noise(session.get(), 1, 2e-5, 4e-3));
    session.run(tick, tick + 1);
    const palpate_result& result = session.results[0];
    ASSERT_EQ(result.tissue_force, expected[tick].tissue_force) << tick;
    ASSERT_EQ(result.noise_force, expected[tick].noise_force) << tick;
    ASSERT_EQ(result.force[2], expected[tick].force[2]) << tick;
    ASSERT_EQ(result.depth, expected[tick].depth) << tick;
  }
  EXPECT_GT(session.results[0].tissue_force, 0.0);
}

TEST(Parameters, ThatChangeAreRecordedAndReplayed) {
  const Folder folder;
  const std::string file = folder / "run.h5";
  Session session(recorded(unheld(), file));
  session.run(0, kTouched);
  require(palpate_set_tissue(session.get(), "kidney"));
  require(palpate_set_tissue_value(session.get(), "k1_N_per_m", 77.0));
  require(palpate_set_noise(session.get(), 0, 3e-5, 6e-3));
  session.run(kTouched, kEnd);
  ASSERT_EQ(session.close(), PALPATE_OK) << palpate_last_error();
  const record::Recording recording = record::read_recording(file);
  ASSERT_EQ(recording.changes.size(), 3U);
  EXPECT_EQ(recording.changes[0].tick, kTouched);
  EXPECT_EQ(recording.changes[0].tissue, model::tissue_preset("kidney").numbers());
  EXPECT_EQ(recording.changes[1].tick, kTouched + 1);
  EXPECT_EQ(recording.changes[1].tissue.k1, 77.0);
  EXPECT_EQ(recording.changes[1].tissue.beta, model::tissue_preset("kidney").beta);
  EXPECT_EQ(recording.changes[2].noise, (haptics::LiveNoise{false, 3e-5, 6e-3}));
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

TEST(Parameters, OfTheTissueAreThoseOfTheSceneAndThenOfTheLastChange) {
  Session session(unheld());
  const model::TissueParameters scene = model::tissue_preset("gallbladder");
  EXPECT_EQ(value_of(session, "k1_N_per_m"), scene.k1);
  EXPECT_DOUBLE_EQ(value_of(session, "rest_length_mm"), 1e3 * scene.rest_length);
  EXPECT_DOUBLE_EQ(value_of(session, "t1_us"), 1e6 * scene.t1);
  EXPECT_EQ(value_of(session, "contact.friction"), scene.contact.friction);
  EXPECT_EQ(value_of(session, "contact.tangential_N_per_m"), 10.0 * scene.k1);  // not given: 10 k1
  require(palpate_set_tissue_value(session.get(), "contact.friction", 0.625));
  require(palpate_set_tissue_value(session.get(), "rest_length_mm", 10.25));
  EXPECT_EQ(value_of(session, "contact.friction"), 0.625);
  EXPECT_EQ(value_of(session, "rest_length_mm"), 10.25);
  require(palpate_restart(session.get()));
  EXPECT_EQ(value_of(session, "contact.friction"), scene.contact.friction);
}

TEST(Parameters, HaveANameForEveryNumberOfTheTissueWhichCanBeReadAndSet) {
  Session session(unheld());
  std::set<std::string> names;
  const char* name = nullptr;
  for (std::size_t index = 0; (name = palpate_tissue_field(index)) != nullptr; ++index) {
    names.insert(name);
    EXPECT_EQ(palpate_set_tissue_value(session.get(), name, value_of(session, name)), PALPATE_OK)
        << palpate_last_error();
  }
  EXPECT_EQ(names.size(), 20U);
  EXPECT_EQ(names.count("max_length_mm"), 1U);
  EXPECT_EQ(names.count("reach.bar_ratio"), 1U);
  EXPECT_EQ(names.count("contact.grip_limit_N"), 1U);
  EXPECT_EQ(palpate_tissue_field(1000), nullptr);
}

TEST(Parameters, OfTheNoiseAreThoseOfTheLastChange) {
  Session session(unheld());
  std::int32_t enabled = -1;
  double gain = 0.0;
  double threshold = 0.0;
  require(palpate_get_noise(session.get(), &enabled, &gain, &threshold));
  EXPECT_EQ(gain, 5e-5);  // the scene's defaults
  EXPECT_EQ(threshold, 5e-3);
  EXPECT_EQ(enabled, 1);
  require(palpate_set_noise(session.get(), 0, 1e-5, 2e-3));
  require(palpate_get_noise(session.get(), &enabled, &gain, &threshold));
  EXPECT_EQ(gain, 1e-5);
  EXPECT_EQ(threshold, 2e-3);
  EXPECT_EQ(enabled, 0);
  session.run(0, kEnd);
  EXPECT_EQ(session.results[0].noise_force, 0.0);
}

TEST(Parameters, OfATissueFileAreRead) {
  const Folder folder;
  std::ofstream(folder / "soft.toml")
      << "[tissue]\nk1_N_per_m = 12.5\nbeta = 1.6\nq = 0.7\nrest_length_mm = 14\n"
         "max_length_mm = 22\nmin_length_mm = 6\nt1_us = 1\n";
  Session session(unheld());
  require(palpate_set_tissue(session.get(), (folder / "soft.toml").c_str()));
  EXPECT_EQ(value_of(session, "k1_N_per_m"), 12.5);
}

TEST(Parameters, ThatAreInvalidAreRefusedAndNothingChanges) {
  Session session(unheld());
  const double k1 = value_of(session, "k1_N_per_m");
  const auto refused = [&](palpate_status status, const char* words) {
    EXPECT_EQ(status, PALPATE_ERROR_INPUT);
    EXPECT_THAT(palpate_last_error(), HasSubstr(words));
  };
  refused(palpate_set_tissue(session.get(), "granite"), "granite");
  refused(palpate_set_tissue_value(session.get(), "stiffness", 1.0),
          "field = \"stiffness\": must be one of k1_N_per_m, beta, q,");
  refused(palpate_set_tissue_value(session.get(), "k1_N_per_m", -1.0), "k1_N_per_m = -1");
  refused(palpate_set_tissue_value(session.get(), "beta", std::numeric_limits<double>::quiet_NaN()),
          "beta = ");
  refused(palpate_set_tissue_value(session.get(), "max_length_mm", 0.001), "rest_length_mm");
  refused(palpate_set_tissue_value(session.get(), "contact.reference_radius_mm", 3.0),
          "cannot change during a run");
  refused(palpate_set_noise(session.get(), 1, -1e-5, 5e-3), "gain_N_m = -1e-05");
  refused(palpate_set_noise(session.get(), 1, 1e-5, 0.0), "threshold_mm = 0");
  double value = 0.0;
  refused(palpate_get_tissue_value(session.get(), "", &value), "field = \"\"");
  EXPECT_EQ(palpate_set_tissue(nullptr, "liver"), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_set_tissue(session.get(), nullptr), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_set_tissue_value(session.get(), nullptr, 1.0), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_get_tissue_value(session.get(), "beta", nullptr), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_set_noise(nullptr, 0, 1e-5, 5e-3), PALPATE_ERROR_USE);
  EXPECT_EQ(palpate_get_noise(session.get(), nullptr, &value, &value), PALPATE_ERROR_USE);
  EXPECT_EQ(value_of(session, "k1_N_per_m"), k1);
  // The loop takes one change per tick, and 32 may wait.
  for (int i = 0; i < 32; ++i) require(palpate_set_noise(session.get(), 1, 1e-5, 5e-3));
  refused(palpate_set_noise(session.get(), 1, 1e-5, 5e-3), "32 changes");
  session.run(0, 1);
  EXPECT_EQ(palpate_set_noise(session.get(), 1, 1e-5, 5e-3), PALPATE_OK);
}

// Game engines change the rounding mode.
TEST(Parameters, ThatChangeUnderAnotherRoundingModeGiveTheSameForces) {
  Session plain(unheld());
  Session upward(unheld());
  require(palpate_set_tissue_value(plain.get(), "rest_length_mm", 12.3));
  std::fesetround(FE_UPWARD);
  const palpate_status status = palpate_set_tissue_value(upward.get(), "rest_length_mm", 12.3);
  std::fesetround(FE_TONEAREST);
  require(status);
  plain.run(0, kEnd);
  upward.run(0, kEnd);
  EXPECT_EQ(plain.results[0].force[2], upward.results[0].force[2]);
  EXPECT_EQ(plain.results[0].depth, upward.results[0].depth);
}

}  // namespace
}  // namespace palpate::tests
