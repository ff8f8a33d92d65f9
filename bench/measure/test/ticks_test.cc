#include "bench/measure/ticks.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bench/measure/bench_scene.h"
#include "bench/measure/hands.h"
#include "bench/measure/loop_comparison.h"
#include "bench/measure/test/sample_scene.h"

// Tests counts, never durations.
namespace palpate::bench {
namespace {

constexpr haptics::Waiting kSleep = haptics::Waiting::kSleep;

const scene::Scene& ticks_setup() {
  static const scene::Scene scene = sample_scene();
  return scene;
}

const haptics::SimulationWorld& world() {
  static const haptics::SimulationWorld world = scene::make_world(ticks_setup());
  return world;
}

TEST(Ticks, EveryTickOfTheWayIsContactOrApproachOrFar) {
  const scene::ToolPath path = hand_path(ticks_setup());
  const std::vector<PathPoint> way = run_path(ticks_setup(), world(), path);
  std::size_t contact = 0;
  std::size_t approach = 0;
  for (const PathPoint& at : way) {
    if (at.phase != contact::Phase::kApproach) {
      ++contact;
    } else if (at.distance <= kNear) {
      ++approach;
    }
  }
  EXPECT_GT(contact, 1000U);
  EXPECT_GT(approach, 1000U);
  const TickAccount account = time_ticks(ticks_setup(), world(), path, 2);
  EXPECT_EQ(account.contact.samples, 2 * contact);
  EXPECT_EQ(account.approach.samples, 2 * approach);
  EXPECT_EQ(account.repeats, 2);
  EXPECT_EQ(account.contact_least.samples, contact);
  EXPECT_EQ(account.approach_least.samples, approach);
  EXPECT_EQ(account.first.samples, 2U);
  EXPECT_EQ(account.phase, "press");
  EXPECT_EQ(account.organ_triangles, ticks_setup().organ.triangles.size());
  EXPECT_EQ(account.tool_triangles, triangle_count(ticks_setup().tools[0]));
}

TEST(Ticks, ATicksLeastTimeIsNoGreaterThanItsTimes) {
  const TickAccount account = time_ticks(ticks_setup(), world(), hand_path(ticks_setup()), 3);
  EXPECT_LE(account.contact_least.p50_us, account.contact.p50_us);
  EXPECT_LE(account.contact_least.p999_us, account.contact.p999_us);
  EXPECT_LE(account.contact_least.max_us, account.contact.max_us);
  EXPECT_GT(account.contact_least.p50_us, 0.0);
}

TEST(Ticks, TheScratchRecordingIsGone) {
  static_cast<void>(time_ticks(ticks_setup(), world(), hand_path(ticks_setup()), 1));
  const std::string own = "palpate-bench-" + std::to_string(getpid());
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
    EXPECT_EQ(entry.path().filename().string().find(own), std::string::npos) << entry.path();
}

TEST(Ticks, AWayWithoutContactThrows) {
  EXPECT_THROW(static_cast<void>(time_ticks(ticks_setup(), world(), still_path(0.2), 1)), std::runtime_error);
}

TEST(Ticks, TheTipIsTheFarthestVertexAlongTheTool) {
  const std::vector<PathPoint> way = run_path(ticks_setup(), world(), still_path(0.2));
  const std::vector<Vec3> tips = tip_points(ticks_setup(), way);
  ASSERT_EQ(tips.size(), way.size());
  double top = -1.0;
  for (const Vec3& v : ticks_setup().tools[0].parts[0].mesh.vertices) top = std::max(top, v.z());
  EXPECT_NEAR(tips.front().z(), 0.2 + top, 1e-12);
}

TEST(Ticks, NearestPointsAreAskedSixteenAtATime) {
  const std::vector<PathPoint> way = run_path(ticks_setup(), world(), still_path(0.05));
  const NearestAccount account = time_nearest(ticks_setup(), way);
  EXPECT_EQ(account.times.samples, way.size() / kPointsAtOnce);
}

TEST(Preparation, MemoryInUseCountsWhatIsHeld) {
  const std::size_t before = bytes_in_use();
  std::vector<std::vector<char>> held;
  for (int i = 0; i < 100; ++i) held.emplace_back(10'000);
  const std::size_t during = bytes_in_use();
  held.clear();
  held.shrink_to_fit();
  const std::size_t after = bytes_in_use();
  EXPECT_GE(during, before + 1'000'000);
  EXPECT_LE(during, before + 1'200'000);
  EXPECT_LT(after, before + 100'000);
}

TEST(Preparation, AWorldKeepsMemoryAndIsReady) {
  const Prepared prepared = prepare(ticks_setup());
  EXPECT_EQ(prepared.account.organ_triangles, ticks_setup().organ.triangles.size());
  EXPECT_GT(prepared.account.bytes, 24 * ticks_setup().organ.vertices.size());
  EXPECT_EQ(prepared.world.hands(), 1U);
}

TEST(Hands, TheGreatestThatFitsIsFoundByHalving) {
  for (const std::size_t limit : {0U, 1U, 2U, 99U, 150U, 199U}) {
    std::size_t tries = 0;
    const auto fits = [&](std::size_t count) {
      EXPECT_GE(count, 1U);
      EXPECT_LT(count, 200U);
      ++tries;
      return count <= limit;
    };
    EXPECT_EQ(greatest_that_fits(150, 200, fits), limit);
    EXPECT_LE(tries, 10U);
  }
}

TEST(Hands, TheFirstTryIsKeptInsideTheBounds) {
  std::vector<std::size_t> tried;
  const auto fits = [&](std::size_t count) {
    tried.push_back(count);
    return true;
  };
  EXPECT_EQ(greatest_that_fits(0, 3, fits), 2U);
  EXPECT_EQ(greatest_that_fits(900, 3, fits), 2U);
  EXPECT_EQ(tried, (std::vector<std::size_t>{1, 2, 2}));
  EXPECT_EQ(greatest_that_fits(5, 1, fits), 0U);  // nothing to try
}

TEST(Hands, HandsThatNeverTouchThrow) {
  EXPECT_THROW(static_cast<void>(run_hands(ticks_setup(), world(), still_path(0.2), kSleep, 2)),
               std::runtime_error);
}

TEST(Hands, NoHandsAreRefused) {
  EXPECT_THROW(static_cast<void>(run_hands(ticks_setup(), world(), hand_path(ticks_setup()), kSleep, 0)),
               std::invalid_argument);
}

TEST(Hands, EveryHandIsTickedInEveryPeriodOfEveryThread) {
  constexpr std::uint64_t kPeriods = 1000;
  const HandsRun run = run_hands(ticks_setup(), world(), hand_path(ticks_setup()), kSleep, 3, kPeriods);
  EXPECT_EQ(run.hands, 3U);
  EXPECT_LE(run.threads, 3U);
  EXPECT_EQ(run.periods, run.threads * kPeriods);
  EXPECT_EQ(run.round.samples, run.periods);
  EXPECT_EQ(run.wall.samples, run.periods);
  EXPECT_GE(run.worst_p999_us, run.round.p999_us);
}

TEST(LoopContest, BothLoopsRunEveryTickOfThePath) {
  const scene::ToolPath path = still_path(0.05);
  std::size_t said = 0;
  const LoopAccount account = compare_with_empty_loop(ticks_setup(), world(), path, kSleep,
                                                      [&](double, const std::string&) { ++said; });
  EXPECT_EQ(account.ticks, 520U);  // 20 ms and half a second at 1 kHz
  EXPECT_EQ(account.late.samples, 520U);
  EXPECT_EQ(account.late_empty.samples, 520U);
  EXPECT_EQ(account.rate_Hz, 1000.0);
  EXPECT_EQ(said, 3U);  // turns of 0.25 s
}

}  // namespace
}  // namespace palpate::bench
