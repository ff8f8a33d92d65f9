// Runs built-in experiments offline and prints a hash of all their rows, to be compared between builds and
// processors (docs/decisions/0001-determinism.md).
//
// Usage: palpate_golden_hash [EXPECTED]   exit 1 when a hash differs from its line in the file EXPECTED
// The last line is of the C library's own exp, log, sin and cos: it may differ from processor to processor,
// and shows that the comparison would notice (no tick uses them).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "palpate/scene.h"

#include "tests/built_in_experiments.h"

namespace palpate::tests {
namespace {

constexpr std::uint64_t kMostTicks = 4000;

/// Two instruments on an organ that breathes and beats at once.
Rig two_hands() {
  scene::Request request;
  request.task = "press";
  request.organ_motion = {"breathing", "heartbeat"};
  scene::Setup setup = scene::load(request);
  setup.tools.push_back(setup.tools.front());
  setup.devices.push_back(setup.devices.front());
  return Rig(std::move(setup));
}

std::string hexadecimal(std::uint64_t value) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// "TICKS HASH" of a run.
std::string hash_of(Rig rig) {
  const std::uint64_t ticks = std::min(rig.whole_path(), kMostTicks);
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

std::map<std::string, std::string> expected_in(const char* file) {
  std::map<std::string, std::string> expected;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t blank = line.find(' ');
    expected[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return expected;
}

int run(const char* expected_file) {
  const std::array<std::pair<const char*, std::string>, 3> found = {{
      {"gallbladder-press", hash_of(built_in("press"))},
      {"heart-pull", hash_of(built_in("pull"))},
      {"two-hands-on-a-moving-organ", hash_of(two_hands())},
  }};
  int differing = 0;
  std::map<std::string, std::string> expected;
  if (expected_file != nullptr) expected = expected_in(expected_file);
  for (const auto& [name, hash] : found) {
    std::cout << name << ' ' << hash << '\n';
    if (expected_file == nullptr || expected[name] == hash) continue;
    ++differing;
    std::cerr << name << " " << hash << " differs from " << expected_file << ": "
              << (expected[name].empty() ? "no such line" : expected[name])
              << " (tools/check_hashes --update writes it anew)\n";
  }
  std::cout << "# C library " << hash_of_library() << '\n';
  return differing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate::tests

int main(int argc, char** argv) { return palpate::tests::run(argc > 1 ? argv[1] : nullptr); }
