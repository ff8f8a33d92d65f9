// One nearest point and one entry of a segment by the organ's triangles, and whole ticks in approach and in
// contact.
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/geometry/surface_distance.h"
#include "io/scene/make_world.h"
#include "palpate/scripted_device.h"

#include "bench/measure/one_hand.h"
#include "bench/measure/subjects.h"
#include "bench/measure/ticks.h"

namespace {

using namespace palpate;

constexpr double kSegment = 1e-3;  // m, about what a fast hand goes in a tick

/// The press scene with so many triangles (0: as built in), its tree, and the tip's way over it; made once.
struct Scene {
  explicit Scene(std::size_t triangles)
      : setup(bench::subject("press", triangles, 0)), surface(setup.organ), path(bench::hand_path(setup)) {
    devices::ScriptedDevice device(path);
    std::vector<bench::WayPoint> way;
    for (std::uint64_t i = 0; i < device.last_tick(setup.rate_Hz); ++i) {
      const haptics::DeviceState at = device.read(i, static_cast<double>(i) / setup.rate_Hz);
      way.push_back({{at.orientation_D, at.position_D}, at.gripper, contact::Phase::kApproach, 0.0});
    }
    tips = bench::tip_points(setup, way);
  }
  scene::Setup setup;
  geometry::SurfaceDistance surface;
  scene::ToolPath path;
  std::vector<Vec3> tips;
};

const Scene& scene_of(std::int64_t triangles) {
  static std::map<std::int64_t, std::unique_ptr<Scene>> made;
  std::unique_ptr<Scene>& scene = made[triangles];
  if (!scene) scene = std::make_unique<Scene>(static_cast<std::size_t>(triangles));
  return *scene;
}

void nearest_point(benchmark::State& state) {
  const Scene& scene = scene_of(state.range(0));
  std::size_t i = 0;
  std::int32_t guess = -1;
  for (auto _ : state) {
    const geometry::NearestPoint nearest = scene.surface.nearest(scene.tips[i], guess);
    guess = nearest.triangle;
    benchmark::DoNotOptimize(nearest.distance);
    if (++i == scene.tips.size()) i = 0;
  }
}

void first_entry(benchmark::State& state) {
  const Scene& scene = scene_of(state.range(0));
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec3& tip = scene.tips[i];
    benchmark::DoNotOptimize(scene.surface.first_entry(tip, tip - Vec3(0.0, 0.0, kSegment)));
    if (++i == scene.tips.size()) i = 0;
  }
}

/// All ticks of the way in one phase; the others are run, not timed.
void tick_in(benchmark::State& state, contact::Phase phase) {
  const Scene& scene = scene_of(state.range(0));
  const haptics::SimulationWorld world = scene::make_world(scene.setup);
  devices::ScriptedDevice device(scene.path);
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  const std::vector<bench::WayPoint> way = bench::walk(scene.setup, world, scene.path);
  auto hand = std::make_unique<bench::OneHand>(world);
  std::uint64_t next = 0;
  const auto wanted = [&] {
    return way[next].phase == phase &&
           (phase != contact::Phase::kApproach || way[next].distance < bench::kNear);
  };
  for (auto _ : state) {
    if (next == last || !wanted()) {
      state.PauseTiming();
      while (next == last || !wanted()) {
        if (next == last) {
          hand = std::make_unique<bench::OneHand>(world);
          next = 0;
          continue;
        }
        hand->tick(device, next++);
      }
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(hand->tick(device, next++).force);
  }
}

BENCHMARK(nearest_point)->Arg(0)->Arg(6'000)->Arg(100'000)->Arg(1'000'000);
BENCHMARK(first_entry)->Arg(0)->Arg(6'000)->Arg(100'000)->Arg(1'000'000);
BENCHMARK_CAPTURE(tick_in, approach, contact::Phase::kApproach)->Arg(0)->Arg(100'000);
BENCHMARK_CAPTURE(tick_in, contact, contact::Phase::kPress)->Arg(0)->Arg(100'000);

}  // namespace
