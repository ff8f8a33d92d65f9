// The touch noise: a unit sample by its number, and a whole noise force at the default and at another loop
// rate.
#include <cstdint>

#include <benchmark/benchmark.h>

#include "palpate/touch_noise.h"

namespace {

using palpate::noise::NoiseSettings;
using palpate::noise::TouchNoise;

void unit_sample_by_number(benchmark::State& state) {
  std::uint64_t n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(palpate::noise::unit_sample(1, 0, n++));
}

void noise_force(benchmark::State& state) {
  const TouchNoise noise(NoiseSettings{}, static_cast<double>(state.range(0)));
  TouchNoise::State hand;
  constexpr double kDistance = 3e-3;  // m
  std::uint64_t tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(noise.force(hand, true, 0, tick++, kDistance));
}

BENCHMARK(unit_sample_by_number);
BENCHMARK(noise_force)->Arg(1000)->Arg(4000);

}  // namespace
