// Held hands, faults, recordings and the real-time safety of a tick, through the C interface.
#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bindings/c/test/c_session.h"
#include "tests/heap_and_lock_guard.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;

double norm(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

#ifdef PALPATE_GUARDED  // a sanitizer itself allocates and locks
TEST(Tick, UsesNoHeapAndNoLock) {
  Session session(unheld());
  palpate_law* law = nullptr;
  require(palpate_law_open("heart", "pull", 1000.0, &law));
  palpate_response response = fresh<palpate_response>();
  double noise = 0.0;
  bool touched = false;
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  arm_guard();
  for (std::uint64_t number = 0; number < session.info.scripted_ticks; ++number) {
    session.script(number);
    session.tick();
    touched = touched || session.results[0].phase == PALPATE_PRESS;
  }
  (void)palpate_law_force_at(law, 1e-3, &response);
  (void)palpate_law_depth_under(law, 0.1, &response);
  (void)palpate_noise_sample(5e-5, 5e-3, 1, 0, 0, 0.0, &noise);
  disarm_guard();
  palpate_law_close(law);
  EXPECT_EQ(heap_uses() - heap_before, 0U);
  EXPECT_EQ(lock_uses() - locks_before, 0U);
  EXPECT_TRUE(touched);
  EXPECT_NE(noise, 0.0);
}

TEST(Tick, GuardSeesTheHeapOfTheLibraryToo) {
  palpate_simulation* simulation = nullptr;
  palpate_options options = unheld();
  options.scene_file = "none.toml";
  const std::uint64_t heap_before = heap_uses();
  arm_guard();
  const palpate_status status = palpate_open(&options, &simulation);
  disarm_guard();
  EXPECT_EQ(status, PALPATE_ERROR_INPUT);
  EXPECT_GT(heap_uses() - heap_before, 0U);
}
#endif

TEST(HeldHand, GetsNoForceBeforeItHasBeenStillOutsideAndAllOfItAfterTheRamp) {
  Session session;  // by default a hand holds the device
  EXPECT_EQ(session.info.held, 1U);
  session.run(0, 240);
  EXPECT_EQ(session.results[0].engagement, 0.0);
  EXPECT_EQ(norm(session.results[0].device_force), 0.0);
  session.run(240, 1000);
  EXPECT_EQ(session.results[0].engagement, 1.0);
}

TEST(HeldHand, HasARecordingThatReplaysBitForBit) {
  const Folder folder;
  const std::string file = folder / "held.h5";
  Session session(recorded(fresh<palpate_options>(), file));
  session.run(0, 1500);
  require(palpate_reset_fault(session.get(), 1));
  session.run(1500, 3000);
  EXPECT_EQ(palpate_restart(session.get()), PALPATE_ERROR_USE);
  EXPECT_THAT(palpate_last_error(), HasSubstr("while recording"));
  ASSERT_EQ(session.close(), PALPATE_OK);
  const Outcome outcome = run(folder, {"replay", "held.h5", "--verify"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("3000"));
}

TEST(Recording, ThatCannotBeMadeIsAnInputErrorThatNamesTheFile) {
  const Folder folder;
  const std::string file = folder / "none/run.h5";
  palpate_options options = unheld();
  options.record_file = file.c_str();
  palpate_simulation* simulation = nullptr;
  EXPECT_EQ(palpate_open(&options, &simulation), PALPATE_ERROR_INPUT);
  EXPECT_EQ(simulation, nullptr);
  EXPECT_THAT(palpate_last_error(), HasSubstr(file));
}

TEST(Fault, LatchesWithWordsAndZeroForceUntilItIsReset) {
  Session session(unheld());
  session.run(0, 2500);
  ASSERT_GT(norm(session.results[0].device_force), 0.1);
  const palpate_sample good = session.samples[0];
  session.samples[0].position[1] = std::numeric_limits<double>::quiet_NaN();
  session.tick();
  EXPECT_EQ(session.results[0].fault, static_cast<std::uint32_t>(PALPATE_FAULT_NOT_FINITE));
  session.samples[0] = good;
  for (int i = 0; i < 10; ++i) session.tick();
  EXPECT_EQ(norm(session.results[0].device_force), 0.0) << "10 ms later";
  EXPECT_EQ(session.results[0].fault, static_cast<std::uint32_t>(PALPATE_FAULT_NOT_FINITE));
  EXPECT_THAT(palpate_fault_words(session.results[0].fault), HasSubstr("not finite"));
  require(palpate_reset_fault(session.get(), 1));
  session.tick();
  EXPECT_EQ(session.results[0].fault, static_cast<std::uint32_t>(PALPATE_FAULT_NONE));
  for (int i = 0; i < 10; ++i) session.tick();
  EXPECT_GT(norm(session.results[0].device_force), 0.1);
}

TEST(Fault, ThatTheProgramKnowsOfComesWithTheSample) {
  for (std::uint32_t fault = PALPATE_FAULT_NOT_FINITE; fault <= PALPATE_FAULT_FORCE_OFF; ++fault) {
    Session session(unheld());
    session.script(0);
    session.samples[0].fault = fault;
    session.tick();
    EXPECT_EQ(session.results[0].fault, fault);
    EXPECT_STRNE(palpate_fault_words(fault), palpate_fault_words(PALPATE_FAULT_NONE));
  }
  Session session(unheld());
  session.script(0);
  session.samples[0].fault = 77;
  session.tick();
  EXPECT_EQ(session.results[0].fault, static_cast<std::uint32_t>(PALPATE_FAULT_DEVICE)) << "a number of none";
}

// The device frame is the world frame rotated by 90 degrees about z: its x axis is the world's y axis.
TEST(DeviceForce, IsTheWorldsTurnedIntoTheDevicesFrame) {
  palpate_options options = unheld();
  options.scene_text =
      "[organ]\nmesh = \"box\"\npose = { rotation_deg = [30, 20, 0] }\n[tool]\nmesh = \"sphere:5\"\n"
      "[device]\nbase = { rotation_deg = [0, 0, 90] }\n";
  Session session(options);
  session.run(0, 2500);
  const palpate_result& result = session.results[0];
  ASSERT_GT(std::abs(result.force[0]), 1e-3);
  EXPECT_NEAR(result.device_force[0], result.force[1], 1e-12);
  EXPECT_NEAR(result.device_force[1], -result.force[0], 1e-12);
  EXPECT_NEAR(result.device_force[2], result.force[2], 1e-12);
}

}  // namespace
}  // namespace palpate::tests
