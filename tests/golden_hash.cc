// Runs built-in experiments offline and prints a hash of all rows of each, for comparison between builds and
// processors (docs/decisions/0001-determinism.md).
// Usage: palpate_golden_hash [EXPECTED]
// Exits with 1 when a hash differs from its line in the file EXPECTED. The last line is a hash of the C
// library's own exp, log, sin and cos. It may differ between processors, which shows that the comparison
// detects such differences; ticks do not use these functions.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>

#include "palpate/recording.h"
#include "palpate/scene.h"

#include "tests/built_in_experiments.h"
#include "tests/hash_file.h"

namespace palpate::tests {
namespace {

constexpr std::uint64_t kMaxTicks = 4000;

/// Two instruments on an organ with breathing and heartbeat.
Rig two_hands() {
  scene::Overrides request;
  request.task = "press";
  request.organ_motion = {"breathing", "heartbeat"};
  scene::Scene setup = scene::load(request);
  setup.tools.push_back(setup.tools.front());
  setup.devices.push_back(setup.devices.front());
  return Rig(std::move(setup));
}

/// "TICKS HASH" of a run.
std::string hash_of(Rig rig) {
  const std::uint64_t ticks = std::min(rig.whole_path(), kMaxTicks);
  RowKeeper rows(ticks * rig.world.hands());
  (void)rig.run({&rows}, {.ticks = ticks, .offline = true});
  return std::to_string(ticks) + " " + hexadecimal(record::hash_rows(rows.rows));
}

std::string hash_of_library() {
  constexpr int kSamples = 100'000;
  std::uint64_t hash = record::kHashStart;
  for (int i = 0; i < kSamples; ++i) {
    const double x = 0.1 + 1.234567e-4 * i;
    for (const double value : {std::exp(x), std::log(x), std::sin(x), std::cos(x)}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ULL;
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
