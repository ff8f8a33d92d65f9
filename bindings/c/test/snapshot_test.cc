// Snapshots of a simulation, for display.
#include <gtest/gtest.h>

#include "io/system/clock.h"
#include "palpate/scene.h"

#include "bindings/c/simulation.h"
#include "bindings/c/test/c_session.h"

namespace palpate::tests {
namespace {

TEST(TickedSnapshot, CarriesTheLatchedFault) {
  Session session;
  session.script(0);
  session.samples[0].fault = PALPATE_FAULT_DEVICE;
  session.tick();
  const haptics::Snapshot& snapshot = session.get()->newest_snapshot();
  EXPECT_EQ(snapshot.faults[0], haptics::Fault::kDevice);
}

TEST(TickedSnapshot, CarriesTheReachOfTheTissueInForceAlsoBeforeTheFirstTick) {
  scene::Scene scene = scene::load({});
  scene.tissue.reach.bar_ratio += 0.5;
  palpate_simulation simulation(c_interface::load(scene, {}, true), fresh<palpate_options>());
  EXPECT_EQ(simulation.newest_snapshot().reach, scene.tissue.reach);
  EXPECT_EQ(simulation.newest_snapshot().change, 0U) << "the interface has no parameter updates";
}

TEST(TickedSnapshot, CarriesTheTimeOfItsTick) {
  Session session;
  const std::int64_t before = monotonic_ns();
  session.run(0, 1);
  const std::int64_t taken = session.get()->newest_snapshot().taken_ns;
  EXPECT_GE(taken, before);
  EXPECT_LE(taken, monotonic_ns());
}

}  // namespace
}  // namespace palpate::tests
