#include "bench/measure/preparation.h"

#include <optional>
#include <utility>
#include <vector>

#include <malloc.h>

#include "io/scene/make_world.h"
#include "io/system/clock.h"

namespace palpate::bench {
std::size_t bytes_in_use() {
  const struct mallinfo2 held = mallinfo2();
  return held.uordblks + held.hblkhd;
}

Prepared prepare(const scene::Scene& scene) {
  constexpr std::size_t kTimes = 5;
  constexpr double kLongest = 1.0;  // s, for all runs but the first
  std::vector<double> seconds;
  std::optional<haptics::SimulationWorld> world;
  std::size_t bytes = 0;
  double all = 0.0;
  while (seconds.empty() || (seconds.size() < kTimes && all + seconds.back() < kLongest)) {
    world.reset();
    const std::size_t before = bytes_in_use();
    const std::int64_t begun = monotonic_ns();
    world.emplace(scene::make_world(scene));
    seconds.push_back(static_cast<double>(monotonic_ns() - begun) * 1e-9);
    all += seconds.back();
    const std::size_t after = bytes_in_use();
    bytes = after > before ? after - before : 0;
  }
  return {std::move(*world), {scene.organ_name, scene.organ.triangles.size(), median(seconds), bytes}};
}

}  // namespace palpate::bench
