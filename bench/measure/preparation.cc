#include "bench/measure/preparation.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <malloc.h>

#include "io/scene/make_world.h"
#include "io/system/clock.h"

namespace palpate::bench {
namespace {

/// The size that malloc_info() says behind `tag`, the last one: the sum over all arenas.
std::size_t size_of(const std::string& account, const std::string& tag) {
  const std::size_t at = account.rfind(tag);
  if (at == std::string::npos) return 0;
  constexpr const char* kSize = "size=\"";
  const std::size_t size = account.find(kSize, at);
  return size == std::string::npos ? 0 : std::strtoull(account.c_str() + size + 6, nullptr, 10);
}

}  // namespace

std::size_t bytes_in_use() {
  char* text = nullptr;
  std::size_t length = 0;
  std::FILE* memory = open_memstream(&text, &length);
  if (memory == nullptr) return 0;
  const int refused = malloc_info(0, memory);
  std::fclose(memory);
  const std::string account(text, length);
  std::free(text);
  if (refused != 0) return 0;
  const std::size_t held = size_of(account, "<system type=\"current\"");
  const std::size_t free_again =
      size_of(account, "<total type=\"fast\"") + size_of(account, "<total type=\"rest\"");
  return held - std::min(held, free_again) + size_of(account, "<total type=\"mmap\"");
}

Prepared prepare(const scene::Setup& setup) {
  constexpr std::size_t kTimes = 5;
  constexpr double kLongest = 1.0;  // s, for all but the first
  std::vector<double> seconds;
  std::optional<haptics::SimulationWorld> world;
  std::size_t bytes = 0;
  double all = 0.0;
  while (seconds.empty() || (seconds.size() < kTimes && all + seconds.back() < kLongest)) {
    world.reset();
    const std::size_t before = bytes_in_use();
    const std::int64_t begun = monotonic_ns();
    world.emplace(scene::make_world(setup));
    seconds.push_back(static_cast<double>(monotonic_ns() - begun) * 1e-9);
    all += seconds.back();
    const std::size_t after = bytes_in_use();
    bytes = after > before ? after - before : 0;
  }
  return {std::move(*world), {setup.organ_name, setup.organ.triangles.size(), median(seconds), bytes}};
}

}  // namespace palpate::bench
