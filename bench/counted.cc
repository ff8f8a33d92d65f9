// The work whose instructions tools/check_counts counts with callgrind: the law in both directions, the
// noise, and a tick in approach and in contact, with the built-in tool, with one of 97,000 triangles, and
// with a needle before and after it punctures the surface.
// Without callgrind it does the same work and prints nothing.
#include <cstdint>
#include <cstdio>

#include <valgrind/callgrind.h>

#include "io/scene/default_path.h"
#include "io/scene/make_world.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

#include "bench/measure/bench_scene.h"
#include "bench/measure/one_hand.h"

namespace {

using namespace palpate;

constexpr std::uint64_t kCalls = 1000;
constexpr std::uint64_t kTicks = 200;

// A client request needs a static text; each dump names the work and the number of calls.
#define PALPATE_COUNTED(what, calls) CALLGRIND_DUMP_STATS_AT(what " calls=" #calls)

/// Counts a thousand calls of `work`.
template <typename Work>
double thousand(Work work) {
  double sum = 0.0;
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  for (std::uint64_t i = 0; i < kCalls; ++i)
    sum += work(static_cast<double>(i) / static_cast<double>(kCalls), i);
  return sum;
}

void count_law_and_noise() {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.max_depth.reset();  // count all layers
  const model::LayeredSpringLaw law(tissue, model::Direction::kPress, 1e-3);
  constexpr double kDeepest = 20e-3;  // m
  const double largest = law.force_at(kDeepest).force;
  volatile double kept =
      thousand([&](double share, std::uint64_t) { return law.force_at(kDeepest * share).force; });
  PALPATE_COUNTED("force at a depth", 1000);
  CALLGRIND_STOP_INSTRUMENTATION;
  kept = thousand([&](double share, std::uint64_t) { return law.deformation_under(largest * share).depth; });
  PALPATE_COUNTED("depth under a force", 1000);
  CALLGRIND_STOP_INSTRUMENTATION;
  kept = thousand([](double, std::uint64_t i) { return noise::unit_sample(1, 0, i); });
  PALPATE_COUNTED("noise sample by number", 1000);
  CALLGRIND_STOP_INSTRUMENTATION;
  static_cast<void>(kept);
}

/// Counts the next 200 ticks of the path.
void count_ticks(bench::OneHand& hand, haptics::Device& device, std::uint64_t& next) {
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  for (const std::uint64_t end = next + kTicks; next < end; ++next) hand.tick(device, next);
}

/// Advances until the phase is `wanted` and, in contact, the depth is a millimetre. @return false at the end
/// of the path
bool go_to(bench::OneHand& hand, haptics::Device& device, contact::Phase wanted, std::uint64_t& next,
           std::uint64_t last) {
  constexpr double kDeep = 1e-3;  // m
  constexpr double kNear = 5e-3;  // m
  while (next < last) {
    const haptics::TickRow& row = hand.tick(device, next++);
    if (row.phase != static_cast<std::uint32_t>(wanted)) continue;
    if (wanted == contact::Phase::kApproach ? row.distance < kNear : row.depth > kDeep) return true;
  }
  return false;
}

/// Counts ticks in two phases of the scene's path. @return false when the path does not have them
template <typename First, typename Second>
bool count_phases(const scene::Scene& scene, contact::Phase first, First dump_first, contact::Phase second,
                  Second dump_second) {
  const haptics::SimulationWorld world = scene::make_world(scene);
  devices::ScriptedDevice device(bench::hand_path(scene));
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  bench::OneHand hand(world);
  std::uint64_t next = 0;
  if (!go_to(hand, device, first, next, last)) return false;
  count_ticks(hand, device, next);
  dump_first();
  CALLGRIND_STOP_INSTRUMENTATION;
  if (!go_to(hand, device, second, next, last)) return false;
  count_ticks(hand, device, next);
  dump_second();
  CALLGRIND_STOP_INSTRUMENTATION;
  return true;
}

/// Counts ticks shortly before and after first contact. @param inclusions their number, under the place of
/// the press
template <typename Approach, typename Contact>
bool count_tick(std::size_t tool_triangles, std::size_t inclusions, Approach dump_approach,
                Contact dump_contact) {
  scene::Scene scene = bench::bench_scene("press", 0, tool_triangles);
  for (std::size_t i = 0; i < inclusions; ++i) {
    scene.inclusions.push_back({});
    scene.inclusions.back().inclusion.radius = 1e-3;
    scene.inclusions.back().inclusion.centre_S = scene.organ_pose.inverse() * scene::default_touch(scene, 0) -
                                                 Vec3(0.0, 0.0, 5e-3 + 0.5e-3 * static_cast<double>(i));
  }
  return count_phases(scene, contact::Phase::kApproach, dump_approach, contact::Phase::kPress, dump_contact);
}

}  // namespace

int main() {
  count_law_and_noise();
  const bool counted = count_tick(
                           0, 0, [] { PALPATE_COUNTED("tick in approach", 200); },
                           [] { PALPATE_COUNTED("tick in contact", 200); }) &&
                       count_tick(
                           0, 1, [] { PALPATE_COUNTED("tick in approach with 1 inclusion", 200); },
                           [] { PALPATE_COUNTED("tick in contact with 1 inclusion", 200); }) &&
                       count_tick(
                           0, 8, [] { PALPATE_COUNTED("tick in approach with 8 inclusions", 200); },
                           [] { PALPATE_COUNTED("tick in contact with 8 inclusions", 200); }) &&
                       count_tick(
                           97'000, 0, [] { PALPATE_COUNTED("dense tool in approach", 200); },
                           [] { PALPATE_COUNTED("dense tool in contact", 200); }) &&
                       count_phases(
                           bench::bench_scene("insert", 0, 0), contact::Phase::kPress,
                           [] { PALPATE_COUNTED("needle before the puncture", 200); },
                           contact::Phase::kInsert, [] { PALPATE_COUNTED("needle inside", 200); });
  if (counted) return 0;
  std::fputs("palpate_counted: the path never came into contact\n", stderr);
  return 1;
}
