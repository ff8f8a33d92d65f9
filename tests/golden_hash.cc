// Runs built-in experiments offline and prints a hash of all rows of each, for comparison between builds and
// processors (docs/decisions/0001-determinism.md).
// Usage: palpate_golden_hash [EXPECTED]
// Exits with 1 when a hash differs from its line in the file EXPECTED. The last line is a hash of the C
// library's own exp, log, sin and cos. It may differ between processors, which shows that the comparison
// detects such differences; ticks do not use these functions.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "core/base/charconv.h"
#include "core/haptics/simulation.h"
#include "io/scene/make_world.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"

#include "tests/hash_file.h"

namespace palpate::tests {
namespace {

constexpr std::uint64_t kMaxTicks = 4000;

/// The press or pull of the paper.
scene::Scene built_in(const std::string& task) {
  scene::Overrides request;
  request.task = task;
  return scene::load(request);
}

/// Two instruments on an organ with breathing and heartbeat.
scene::Scene two_hands() {
  scene::Overrides request;
  request.task = "press";
  request.organ_motion = {"breathing", "heartbeat"};
  scene::Scene scene = scene::load(request);
  scene.tissue.max_depth.reset();  // the organ breathes deeper than that onto the tools
  scene.tools.push_back(scene.tools.front());
  scene.devices.push_back(scene.devices.front());
  return scene;
}

/// "TICKS HASH" of a run on the scene's paths.
std::string hash_of(const scene::Scene& scene) {
  const haptics::SimulationWorld world = scene::make_world(scene);
  haptics::SimulationState state(world);
  std::vector<devices::ScriptedDevice> hands;
  std::uint64_t ticks = 0;
  for (std::size_t hand = 0; hand < world.hands(); ++hand) {
    hands.emplace_back(scene::default_path(scene, hand).faster(scene.devices[hand].path_speed));
    ticks = std::max(ticks, hands.back().last_tick(world.rate_Hz));
  }
  ticks = std::min(ticks, kMaxTicks);
  std::vector<haptics::DeviceState> samples(world.hands());
  std::vector<haptics::ForceCommand> commands(world.hands());
  std::vector<haptics::TickRow> rows(world.hands());
  std::uint64_t hash = record::kHashStart;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    for (std::size_t hand = 0; hand < hands.size(); ++hand) {
      samples[hand] = hands[hand].read(tick, static_cast<double>(tick) / world.rate_Hz);
    }
    haptics::tick(world, state, tick, samples, commands, rows);
    hash = record::hash_rows(rows, hash);
  }
  return std::to_string(ticks) + " " + hexadecimal(hash);
}

std::string hash_of_library() {
  constexpr int kSamples = 100'000;
  std::uint64_t hash = record::kHashStart;
  for (int i = 0; i < kSamples; ++i) {
    const double x = 0.1 + 1.234567e-4 * i;
    for (const double value : {std::exp(x), std::log(x), std::sin(x), std::cos(x)}) {
      hash = (hash ^ bit_cast<std::uint64_t>(value)) * 1099511628211ULL;
    }
  }
  return hexadecimal(hash);
}

int run(const char* expected_file) {
  const std::array<std::pair<const char*, std::string>, 3> found = {{
      {"gallbladder-press", hash_of(built_in("press"))},
      {"heart-pull", hash_of(built_in("pull"))},
      {"two-hands-on-a-moving-organ", hash_of(two_hands())},
  }};
  int differing = 0;
  for (const auto& [name, hash] : found) differing += check_hash(name, hash, expected_file) ? 0 : 1;
  if (differing > 0) std::cerr << "tools/check_hashes --update rewrites the file\n";
  std::cout << "# C library " << hash_of_library() << '\n';
  return differing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate::tests

int main(int argc, char** argv) { return palpate::tests::run(argc > 1 ? argv[1] : nullptr); }
