#include "tests/built_in_experiments.h"

#include <algorithm>
#include <utility>

#include "io/scene/make_world.h"
#include "palpate/scene.h"
#include "run/devices/devices.h"
#include "run/realtime/loop.h"

namespace palpate::tests {

Rig::Rig(scene::Scene resolved) : scene(std::move(resolved)), world(scene::make_world(scene)) {
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    devices.push_back(devices::open_device(scene, hand));
  }
}

std::uint64_t Rig::whole_path() const {
  std::uint64_t last = 0;
  for (const auto& device : devices) last = std::max(last, device->last_tick(scene.rate_Hz));
  return last;
}

haptics::LoopReport Rig::run(const std::vector<haptics::TickObserver*>& observers,
                             const realtime::LoopOptions& options) {
  haptics::SimulationState state(world);
  std::vector<haptics::Device*> plain;
  for (const auto& device : devices) plain.push_back(device.get());
  return realtime::run_loop(world, state, plain, observers, options);
}

Rig built_in(const std::string& task) {
  scene::Overrides request;
  request.task = task;
  if (task == "moving") {
    request.task = "press";
    request.organ_motion = {"breathing", "heartbeat"};
  }
  return Rig(scene::load(request));
}

bool same_bits(haptics::TickRow a, haptics::TickRow b) {
  a.tick_ns = b.tick_ns = 0;
  a.late_ns = b.late_ns = 0;
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): compares bits, with -0 and NaN
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace palpate::tests
