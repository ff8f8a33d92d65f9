// Calls from the loop to its observers, and the contents of the snapshot.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/haptics/test/test_world.h"
#include "io/system/clock.h"
#include "palpate/parameter_updates.h"
#include "palpate/tick_observer.h"
#include "run/realtime/loop.h"

namespace palpate::realtime {
namespace {

using haptics::test::block_and_balls;
using haptics::test::FakeDevice;
using haptics::test::pressing;
using haptics::test::RowKeeper;

TEST(SnapshotPublisher, HandsOverTheNewestTick) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  FakeDevice device([](std::uint64_t, double time) { return pressing(time); });
  haptics::Device* devices[] = {&device};
  RowKeeper rows(450);
  haptics::SnapshotPublisher publisher;
  (void)run_loop(world, state, devices, {&rows, &publisher}, {.ticks = 450, .offline = true});
  ASSERT_TRUE(publisher.cell().refresh());
  const haptics::Snapshot& newest = publisher.cell().value();
  EXPECT_EQ(newest.tick, 449u);
  EXPECT_EQ(newest.hands, 1u);
  EXPECT_EQ(newest.organ_W.position, world.organ_W.position);
  EXPECT_EQ(newest.tools[0].pose_W.position.z(), rows.rows.back().tool[2]);
  EXPECT_EQ(newest.results[0].depth, rows.rows.back().depth);
  EXPECT_EQ(newest.commands[0].force.z(), rows.rows.back().force[2]);
}

TEST(Snapshot, CarriesFaultsParametersAndTheTimeOfItsTick) {
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  haptics::ParameterUpdates updates(world, tissue, {});
  tissue.reach.bar_ratio = 1.5 * tissue.reach.bar_ratio;
  (void)updates.offer(tissue);
  haptics::RunControl control(&updates);
  FakeDevice device([](std::uint64_t, double time) { return pressing(time); });
  device.failing_write = 30;
  haptics::Device* devices[] = {&device};
  haptics::SnapshotPublisher publisher;
  const std::int64_t before = monotonic_ns();
  (void)run_loop(world, state, devices, {&publisher},
                 {.ticks = 45, .control = &control, .stalled_after_ns = 0});
  ASSERT_TRUE(publisher.cell().refresh());
  const haptics::Snapshot& newest = publisher.cell().value();
  EXPECT_EQ(newest.tick, 44u);
  EXPECT_EQ(newest.faults[0], haptics::Fault::kDevice) << "latched since tick 30";
  EXPECT_EQ(newest.change, 1u);
  EXPECT_EQ(newest.reach, tissue.reach);
  EXPECT_GT(newest.taken_ns, before);
  EXPECT_LE(newest.taken_ns, monotonic_ns());
}

TEST(TickObserver, ObserversAreCalledInTheirOrderRowsBeforeTheTick) {
  class Witness final : public haptics::TickObserver {
   public:
    Witness(std::string name, std::vector<std::string>& calls) : name_(std::move(name)), calls_(calls) {}
    void on_start(std::int64_t) noexcept override { calls_.push_back(name_ + " start"); }
    void on_row(const haptics::TickRow&) noexcept override { calls_.push_back(name_ + " row"); }
    void on_tick(const haptics::TickState&) noexcept override { calls_.push_back(name_ + " tick"); }

   private:
    std::string name_;
    std::vector<std::string>& calls_;
  };
  const haptics::SimulationWorld world = block_and_balls(1, 1000.0);
  haptics::SimulationState state(world);
  FakeDevice device([](std::uint64_t, double time) { return pressing(time); });
  haptics::Device* devices[] = {&device};
  std::vector<std::string> calls;
  Witness a("a", calls);
  Witness b("b", calls);
  (void)run_loop(world, state, devices, {&a, &b}, {.ticks = 1, .offline = true});
  EXPECT_EQ(calls, (std::vector<std::string>{"a start", "b start", "a row", "b row", "a tick", "b tick"}));
}

}  // namespace
}  // namespace palpate::realtime
