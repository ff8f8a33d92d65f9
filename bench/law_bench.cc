// The force law both ways, for every built-in tissue over 0 to 15 mm.
#include <string>

#include <benchmark/benchmark.h>

#include "palpate/spring_law.h"

namespace {

using palpate::model::Direction;
using palpate::model::LayeredSpringLaw;

constexpr double kDeepest = 15e-3;       // m
constexpr double kStep = 0.38196601125;  // of the range; irrational, so that the depths never repeat

LayeredSpringLaw law_of(const std::string& tissue) {
  return {palpate::model::tissue_preset(tissue), Direction::kPress, 1e-3};
}

void force_at_depth(benchmark::State& state, const std::string& tissue) {
  const LayeredSpringLaw law = law_of(tissue);
  double share = 0.0;
  for (auto _ : state) {
    share += kStep;
    if (share >= 1.0) share -= 1.0;
    benchmark::DoNotOptimize(law.force_at(kDeepest * share));
  }
}

void deformation_under_force(benchmark::State& state, const std::string& tissue) {
  const LayeredSpringLaw law = law_of(tissue);
  const double largest = law.force_at(kDeepest).force;
  double share = 0.0;
  for (auto _ : state) {
    share += kStep;
    if (share >= 1.0) share -= 1.0;
    benchmark::DoNotOptimize(law.deformation_under(largest * share));
  }
}

BENCHMARK_CAPTURE(force_at_depth, gallbladder, "gallbladder");
BENCHMARK_CAPTURE(force_at_depth, heart, "heart");
BENCHMARK_CAPTURE(force_at_depth, liver, "liver");
BENCHMARK_CAPTURE(force_at_depth, kidney, "kidney");
BENCHMARK_CAPTURE(deformation_under_force, gallbladder, "gallbladder");
BENCHMARK_CAPTURE(deformation_under_force, heart, "heart");
BENCHMARK_CAPTURE(deformation_under_force, liver, "liver");
BENCHMARK_CAPTURE(deformation_under_force, kidney, "kidney");

}  // namespace
