// How often the bounding-volume hierarchy of an organ is built.
#include "io/scene/organ_distance.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "io/scene/default_path.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/parameter_updates.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::scene {
namespace {

using geometry::SignedDistance;

/// Hierarchies built by `action`.
template <class Action>
std::uint64_t builds_in(Action action) {
  const std::uint64_t before = SignedDistance::builds();
  action();
  return SignedDistance::builds() - before;
}

Overrides with_nodules(const std::string& organ, const std::string& task) {
  Overrides request;
  request.organ = organ;
  request.task = task;
  request.tools = {"sphere:5"};
  request.device = "emulated";
  request.inclusions = {"nodule"};
  return request;
}

/// Everything that a session prepares from a scene.
void prepare(const Overrides& request) {
  const Scene scene = load(request);
  (void)default_path_remarks(scene);
  (void)default_path(scene, 0);
  const haptics::SimulationWorld world = make_world(scene);
  (void)stability_remarks(scene, world);
}

TEST(OrganDistance, ASessionBuildsOneOfTheOrganAndOneOfItsRefinement) {
  for (const char* task : {"press", "palpate"}) {
    EXPECT_EQ(builds_in([&] { prepare(with_nodules("liver", task)); }), 2U) << task;
  }
}

TEST(OrganDistance, ASessionBuildsOneOfAnOrganThatNeedsNoRefinement) {
  Scene scene = load(with_nodules("ball", "press"));
  scene.organ = geometry::refine(scene.organ, scene.tissue.contact.reference_radius / 5.0);
  EXPECT_EQ(builds_in([&] {
              (void)default_path(scene, 0);
              (void)make_world(scene);
              (void)default_touch(scene, 0);
            }),
            1U);
}

TEST(OrganDistance, AStepOfASliderBuildsNone) {
  const Scene scene = load(with_nodules("ball", "press"));
  const haptics::SimulationWorld world = make_world(scene);
  const std::unique_ptr<haptics::ParameterUpdates> updates = make_parameter_updates(scene, world);
  model::TissueParameters stiffer = scene.tissue;
  stiffer.k1 *= 1.1;
  const Vec3 centre = scene.inclusions[0].inclusion.centre_S;
  EXPECT_EQ(builds_in([&] {
              (void)updates->offer(stiffer);
              (void)updates->offer(haptics::LiveInclusion{0, {centre.x(), centre.y(), centre.z()}, 5.0});
            }),
            0U);
}

TEST(OrganDistance, CopiesOfASceneAndThreadsShareIt) {
  const Scene scene = load(with_nodules("ball", "press"));
  const std::uint64_t builds = builds_in([&] {
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([copy = scene] { (void)organ_distance_of(copy); });
    }
    for (std::thread& thread : threads) thread.join();
  });
  EXPECT_EQ(builds, 0U);  // load() has built it, for the nodule
}

TEST(OrganDistance, IsThatOfAnotherMeshOnceTheOrganIsAnother) {
  Scene scene = load(with_nodules("ball", "press"));
  const Vec3 outside(1.0, 0.0, 0.0);
  const double before = organ_distance_of(scene).nearest(outside).distance;
  for (Vec3& vertex : scene.organ.vertices) vertex *= 0.5;
  const SignedDistance smaller = organ_distance_of(scene);
  EXPECT_GT(smaller.nearest(outside).distance, before);
  EXPECT_EQ(smaller.nearest(outside).distance, SignedDistance(scene.organ).nearest(outside).distance);
  scene.organ.triangles.pop_back();
  EXPECT_THROW((void)organ_distance_of(scene), InputError);
}

}  // namespace
}  // namespace palpate::scene
