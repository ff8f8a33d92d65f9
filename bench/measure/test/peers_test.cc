#include "bench/measure/peers.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bench/measure/bench_scene.h"
#include "bench/measure/test/sample_scene.h"

namespace palpate::bench {
namespace {

const scene::Scene& scene() {
  static const scene::Scene scene = sample_scene();
  return scene;
}

const std::vector<PathPoint>& way() {
  static const std::vector<PathPoint> way = run_path(scene(), scene::make_world(scene()), hand_path(scene()));
  return way;
}

int opened = 0;

void* open_none(const PalpatePeerMesh*, const PalpatePeerMesh*, size_t) { return nullptr; }
void* open_one(const PalpatePeerMesh*, const PalpatePeerMesh*, size_t) { return &++opened; }
double report_a_metre(void*, const double*, const double*) { return 1.0; }
double report_nothing(void*, const double*, const double*) { return std::nan(""); }
double report_touch(void*, const double*, const double*) { return 0.0; }
void close_one(void*) { --opened; }

TEST(Peers, WithoutTheLibraryAllAreMissingByNameAndPackage) {
  const Peers none("/nonexistent/libpalpate_peers.so");
  EXPECT_TRUE(none.all().empty());
  const std::vector<std::string> missing = none.missing();
  ASSERT_EQ(missing.size(), supported_peers().size());
  EXPECT_NE(missing[1].find("FCL"), std::string::npos);
  EXPECT_NE(missing[1].find("libfcl-dev"), std::string::npos);
}

TEST(Peers, EveryKnownOneIsBuiltInOrSaidToBeMissing) {
  const Peers built(PALPATE_PEERS);
  EXPECT_EQ(built.all().size() + built.missing().size(), supported_peers().size());
}

TEST(Peers, ThoseBuiltInAgreeWithPalpateOnEveryDistance) {
  const Peers built(PALPATE_PEERS);
  for (const PalpatePeer& peer : built.all()) {
    const PeerAccount account = measure_peer(peer, {scene(), way(), 1.0});
    EXPECT_EQ(account.name, peer.name);
    EXPECT_GT(account.contact.samples, 0U) << peer.name;
    EXPECT_GT(account.approach.samples, 0U) << peer.name;
    EXPECT_EQ(account.tool_triangles > 0, peer.one_point == 0) << peer.name;
  }
}

TEST(Peers, OneThatRefusesTheOrganThrows) {
  const PalpatePeer peer{"none", "nothing", 0, 0, open_none, report_touch, close_one};
  EXPECT_THROW(static_cast<void>(measure_peer(peer, {scene(), way(), 1.0})), std::runtime_error);
}

TEST(Peers, OneThatAnswersAnotherQuestionThrowsAndIsClosed) {
  const PalpatePeer peer{"far", "nothing", 0, 0, open_one, report_a_metre, close_one};
  EXPECT_THROW(static_cast<void>(measure_peer(peer, {scene(), way(), 1.0})), std::runtime_error);
  EXPECT_EQ(opened, 0);
}

TEST(Peers, OneThatNeverTouchesHasNoFiguresInContact) {
  const PalpatePeer peer{"ghost", "nothing", 0, 1, open_one, report_nothing, close_one};
  const PeerAccount account = measure_peer(peer, {scene(), way(), 1.0});
  EXPECT_EQ(account.contact.samples, 0U);
  EXPECT_GT(account.approach.samples, 0U);
}

TEST(Peers, AllTicksAreAskedWhereThereIsTime) {
  const PalpatePeer peer{"quick", "nothing", 0, 1, open_one, report_touch, close_one};
  std::size_t contact = 0;
  for (const PathPoint& at : way()) contact += at.phase != contact::Phase::kApproach ? 1 : 0;
  const PeerAccount account = measure_peer(peer, {scene(), way(), 1e6});
  EXPECT_EQ(account.contact.samples, contact);
  EXPECT_EQ(opened, 0);
}

}  // namespace
}  // namespace palpate::bench
