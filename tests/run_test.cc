// Tests of whole runs: scene, devices, contact, noise, gate and loop together.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "palpate/builtin.h"
#include "palpate/mesh.h"

#include "tests/built_in_experiments.h"

namespace palpate::tests {
namespace {

namespace fs = std::filesystem;

/// A file that the destructor removes.
class PathFile final {
 public:
  explicit PathFile(const std::string& text)
      : path_(fs::temp_directory_path() / ("palpate_run_test_" + std::to_string(getpid()) + ".csv")) {
    std::ofstream(path_) << text;
  }
  ~PathFile() { fs::remove(path_); }
  PathFile(const PathFile&) = delete;
  PathFile& operator=(const PathFile&) = delete;
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  fs::path path_;
};

/// A 3 mm ball above a block whose top is at z = 0, moved along a path.
scene::Scene ball_and_block(double rate_Hz, const std::string& path) {
  scene::Scene scene;
  scene.name = "ball and block";
  scene.rate_Hz = rate_Hz;
  scene.seed = 5;
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.02);
  scene.tissue = model::tissue_preset("gallbladder");
  scene.tools = {geometry::make_tool("sphere:3")};
  scene.devices = {{"scripted", path, 1.0, {}}};
  return scene;
}

std::vector<haptics::TickRow> rows_of(Rig& rig, std::uint64_t ticks, bool offline = true) {
  RowKeeper keeper(ticks);
  // A scripted device has no hand, so there is no watchdog, as in the program: a stall of the machine is not
  // a fault.
  (void)rig.run({&keeper}, {.ticks = ticks, .offline = offline, .stalled_after_ns = 0});
  return std::move(keeper.rows);
}

TEST(Run, NoiseThreeMillimetresOffTheSurfaceIsTheSameAtOneAndFourKilohertz) {
  const PathFile held("time_s,x_m,y_m,z_m\n0,0.001,0.002,0.006\n");
  Rig slow(ball_and_block(1000.0, held.name()));
  Rig fast(ball_and_block(4000.0, held.name()));
  const auto at_1 = rows_of(slow, 500);
  const auto at_4 = rows_of(fast, 2000);
  ASSERT_EQ(at_1.size(), 500u);
  ASSERT_EQ(at_4.size(), 2000u);
  const noise::NoiseSettings& settings = slow.scene.noise;
  for (std::size_t i = 0; i < at_4.size(); ++i) {
    const haptics::TickRow& row = at_4[i];
    const haptics::TickRow& same = at_1[i / 4];
    ASSERT_EQ(row.noise_force, same.noise_force) << i;
    ASSERT_EQ(row.phase, 0u);
    ASSERT_NEAR(row.distance, 0.003, 2e-5);
    const double sigma = settings.gain / (row.distance + settings.threshold);
    ASSERT_NEAR(row.noise_force, sigma * noise::unit_sample(5, 0, i / 4), 1e-15) << i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(row.force[axis], row.noise_force * row.normal[axis], 1e-15) << i;
    }
    ASSERT_NEAR(row.normal[2], 1.0, 1e-6) << "away from the top";
  }
  EXPECT_NE(at_1[0].noise_force, at_1[1].noise_force);
}

TEST(Run, InContactTheForceIsTheLawsAtTheDepthAndUpwards) {
  const PathFile pressed(
      "time_s,x_m,y_m,z_m\n0,0.001,0.002,0.006\n0.5,0.001,0.002,-0.002\n1,0.001,0.002,-0.002\n");
  scene::Scene scene = ball_and_block(1000.0, pressed.name());
  scene.noise.enabled = false;
  Rig rig(std::move(scene));
  const auto rows = rows_of(rig, 1000);
  const haptics::TickRow& last = rows.back();
  EXPECT_EQ(last.phase, 1u);
  EXPECT_NEAR(last.depth, 0.005, 5e-5) << "3 mm ball, its centre 2 mm below the top";
  const double law = rig.world.contact.press_law().force_at(last.depth).force;
  EXPECT_NEAR(last.tissue_force, law, 0.01 * law);
  EXPECT_NEAR(last.force[2], law, 0.01 * law);
}

void expect_same_rows_in_real_time(const std::string& experiment) {
  SCOPED_TRACE(experiment);
  Rig rig = built_in(experiment);
  const std::uint64_t ticks = rig.whole_path();
  const auto offline = rows_of(rig, ticks);
  const auto real = rows_of(rig, ticks, false);
  ASSERT_EQ(offline.size(), ticks);
  ASSERT_EQ(real.size(), ticks);
  for (std::size_t i = 0; i < ticks; ++i) ASSERT_TRUE(same_bits(offline[i], real[i])) << i;
}

// Runs all at once, because they mostly wait for the next tick during their 7 s.
TEST(BuiltInExperiment, GivesTheSameRowsOfflineAndInRealTime) {
  std::vector<std::thread> threads;
  for (const std::string experiment : {"press", "pull", "moving"}) {
    threads.emplace_back([experiment] { expect_same_rows_in_real_time(experiment); });
  }
  for (std::thread& thread : threads) thread.join();
}

class BuiltInExperimentOffline : public testing::TestWithParam<const char*> {};

TEST_P(BuiltInExperimentOffline, GoesAtLeastTenMillimetresDeepWithoutAFault) {
  Rig rig = built_in(GetParam());
  double deepest = 0.0;
  for (const haptics::TickRow& row : rows_of(rig, rig.whole_path())) {
    deepest = std::max(deepest, row.depth);
    ASSERT_EQ(row.fault, 0u) << row.tick;
  }
  EXPECT_GE(deepest, 0.010);
}

INSTANTIATE_TEST_SUITE_P(All, BuiltInExperimentOffline, testing::Values("press", "pull", "moving"),
                         [](const auto& task) { return std::string(task.param); });

}  // namespace
}  // namespace palpate::tests
