// A tick uses no heap, no lock and no system call except the clock, in both of the paper's experiments and in
// a press on an organ with breathing and heartbeat.
#include <filesystem>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "io/record/recorder.h"
#include "net/igtl_server.h"
#include "net/test/igtl_received.h"

#include "tests/built_in_experiments.h"
#include "tests/heap_and_lock_guard.h"
#include "tests/syscall_guard.h"
#include "tests/tick_bracket.h"

namespace palpate::tests {
namespace {

constexpr std::uint64_t kTicks = 10'000;

class TickPurity : public testing::TestWithParam<const char*> {};

TEST_P(TickPurity, NoHeapUseAndNoLockInTenThousandTicks) {
  Rig rig = built_in(GetParam());
  haptics::SnapshotPublisher publisher;
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  Bracket bracket(kTicks, arm_guard, disarm_guard);
  (void)rig.run({&publisher, &bracket}, {.ticks = kTicks, .offline = true});
  EXPECT_EQ(heap_uses() - heap_before, 0u);
  EXPECT_EQ(lock_uses() - locks_before, 0u);
  EXPECT_GT(bracket.touching, 100u) << "the ticks are of an experiment that touches";
}

TEST_P(TickPurity, NoHeapUseAndNoLockWhileTissueAndNoiseChange) {
  Rig rig = built_in(GetParam());
  haptics::ParameterUpdates changes(rig.world, rig.scene.tissue, {});
  model::TissueParameters tissue = rig.scene.tissue;
  tissue.law = model::LawKind::kSmooth;
  tissue.relaxation = {{0.2, 0.05}, {0.2, 0.5}, {0.1, 5.0}};
  for (std::size_t i = 1; i < haptics::ParameterUpdates::kMaxWaiting; ++i) {
    tissue.k1 *= 1.02;
    (void)changes.offer(tissue);
  }
  (void)changes.offer(haptics::LiveNoise{true, 1e-4, 4e-3});
  haptics::SnapshotPublisher publisher;
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  Bracket bracket(kTicks, arm_guard, disarm_guard);
  haptics::RunControl control(&changes);
  (void)rig.run({&publisher, &bracket}, {.ticks = kTicks, .offline = true, .control = &control});
  EXPECT_EQ(heap_uses() - heap_before, 0u);
  EXPECT_EQ(lock_uses() - locks_before, 0u);
  EXPECT_EQ(changes.waiting(0), nullptr) << "all were taken";
  EXPECT_GT(bracket.touching, 100u) << "the ticks are of an experiment that touches";
}

TEST_P(TickPurity, NoHeapUseAndNoLockWhileAClientLooksOnByOpenIgtLink) {
  Rig rig = built_in(GetParam());
  net::IgtlServer server({"127.0.0.1", 0});
  net::test::Client client(server.port());
  (void)client.next("STATUS", "PalpateStatus");
  Bracket bracket(kTicks, arm_guard, disarm_guard);
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  {
    const net::IgtlRun shown(&server, rig.scene);
    (void)rig.run({&server, &bracket}, {.ticks = kTicks, .offline = true});
  }
  EXPECT_EQ(heap_uses() - heap_before, 0u);
  EXPECT_EQ(lock_uses() - locks_before, 0u);
  const double last = static_cast<double>(kTicks - 1) / rig.world.rate_Hz;
  double shown = 0.0;
  while (shown < last) shown = client.next("SENSOR", "PalpateTime").values()[0];
  EXPECT_EQ(shown, last) << "it saw the last tick";
}

TEST_P(TickPurity, NoSystemCallButTheClockInTenThousandTicks) {
  Rig rig = built_in(GetParam());  // before the fork, because running threads do not survive it
  const FilteredOutcome outcome = run_filtered([&](FilteredPart& part) {
    haptics::SnapshotPublisher publisher;
    Bracket bracket(
        kTicks, [&] { part.start(); }, [&] { part.done(); });
    (void)rig.run({&publisher, &bracket}, {.ticks = kTicks, .offline = true});
  });
  EXPECT_EQ(outcome.forbidden, -1) << "number of the system call";
  EXPECT_TRUE(outcome.done) << "child's status " << outcome.exit_status;
}

/// Expects only clock calls in ticks in real time with a recorder.
void expect_no_system_call_but_the_clock(const char* task, haptics::Waiting waiting) {
  Rig rig = built_in(task);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("palpate_purity_" + std::to_string(getpid()) + ".h5");
  const FilteredOutcome outcome = run_filtered([&](FilteredPart& part) {
    constexpr std::uint64_t kRealTicks = 1500;
    record::Recorder recorder(file, rig.scene, false);
    Bracket bracket(
        kRealTicks, [&] { part.start(); }, [&] { part.done(); });
    (void)rig.run({&recorder, &bracket},
                  {.ticks = kRealTicks, .offline = false, .thread = {.waiting = waiting}});
  });
  std::filesystem::remove(file);
  EXPECT_EQ(outcome.forbidden, -1) << "number of the system call";
  EXPECT_TRUE(outcome.done) << "child's status " << outcome.exit_status;
}

TEST_P(TickPurity, NoSystemCallButTheClockInRealTimeWithARecorder) {
  expect_no_system_call_but_the_clock(GetParam(), haptics::Waiting::kSleep);
}

INSTANTIATE_TEST_SUITE_P(All, TickPurity, testing::Values("press", "pull", "moving"),
                         [](const auto& task) { return std::string(task.param); });

// One experiment is enough, because waiting is independent of it.
TEST(TickPurityPolled, NoSystemCallButTheClockInRealTime) {
  expect_no_system_call_but_the_clock("press", haptics::Waiting::kPoll);
}

TEST(Guards, TheHeapAndLockGuardSeesWhatItIsFor) {
  std::mutex mutex;
  const std::uint64_t heap_before = heap_uses();
  const std::uint64_t locks_before = lock_uses();
  arm_guard();
  ::operator delete(::operator new(8));  // called directly, because a compiler may omit a new-expression
  { const std::lock_guard lock(mutex); }
  disarm_guard();
  EXPECT_GE(heap_uses() - heap_before, 2u);
  EXPECT_GE(lock_uses() - locks_before, 1u);
}

TEST(Guards, TheSystemCallGuardSeesWhatItIsFor) {
  const FilteredOutcome outcome = run_filtered([](FilteredPart& part) {
    part.start();
    (void)getppid();
    part.done();
  });
  EXPECT_NE(outcome.forbidden, -1);
  EXPECT_FALSE(outcome.done);
}

}  // namespace
}  // namespace palpate::tests
