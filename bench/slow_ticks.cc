// Which ticks of the bench's way are slow by themselves: palpate_slow_ticks [press|pull [ORGAN [TOOL
// [PASSES]]]], numbers of triangles, 0 for the built-in ones. Every tick's least processor time over some
// passes leaves out what the machine adds; the figures of all single times, and of plain arithmetic that
// takes as long as a tick does, stand beside it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "io/scene/make_world.h"
#include "io/system/clock.h"
#include "palpate/scripted_device.h"

#include "bench/measure/one_hand.h"
#include "bench/measure/subjects.h"
#include "bench/measure/ticks.h"
#include "bench/measure/times.h"

namespace {

using namespace palpate;

constexpr std::size_t kListed = 20;

struct Tick {
  bool contact = false;
  double distance = 0.0;  // m
  double depth = 0.0;     // m
  double least_us = std::numeric_limits<double>::infinity();
};

struct Times {
  std::vector<Tick> ticks;
  std::vector<double> contact_us, approach_us, plain_us;  // all single times
};

/// Additions, one waiting for the other, that take about as long as a tick.
double plain_arithmetic() {
  volatile double start = 1.0;
  double sum = start;
  for (int i = 0; i < 2000; ++i) sum += 1e-3;
  return sum;
}

template <typename Work>
double time_us(Work work) {
  const std::int64_t begun = thread_cpu_ns();
  work();
  return static_cast<double>(thread_cpu_ns() - begun) / bench::kNanosecondsPerMicrosecond;
}

void time_pass(const haptics::SimulationWorld& world, devices::ScriptedDevice& device, Times& times) {
  bench::OneHand hand(world);
  volatile double kept = 0.0;
  for (std::size_t number = 0; number < times.ticks.size(); ++number) {
    const haptics::TickRow* row = nullptr;
    const double spent = time_us([&] { row = &hand.tick(device, number); });
    Tick& tick = times.ticks[number];
    tick.contact = row->phase != static_cast<std::uint32_t>(contact::Phase::kApproach);
    tick.distance = row->distance;
    tick.depth = row->depth;
    tick.least_us = std::min(tick.least_us, spent);
    if (tick.contact) times.contact_us.push_back(spent);
    if (!tick.contact && tick.distance <= bench::kNear) times.approach_us.push_back(spent);
    times.plain_us.push_back(time_us([&] { kept = plain_arithmetic(); }));
  }
}

void print(const char* what, std::vector<double> times_us) {
  const bench::TimeFigures figures = bench::figures_of(std::move(times_us));
  std::printf("%-34s p50 %6.2f  p99 %6.2f  p99.9 %6.2f  max %7.2f us\n", what, figures.p50_us, figures.p99_us,
              figures.p999_us, figures.max_us);
}

std::vector<double> least_of(const std::vector<Tick>& ticks, bool contact) {
  std::vector<double> least;
  for (const Tick& tick : ticks) {
    if (tick.contact == contact && (contact || tick.distance <= bench::kNear)) least.push_back(tick.least_us);
  }
  return least;
}

void list_slowest(const std::vector<Tick>& ticks) {
  std::vector<std::size_t> order(ticks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return ticks[a].least_us > ticks[b].least_us; });
  order.resize(std::min(kListed, order.size()));
  std::puts("slowest ticks, least of all passes:");
  for (const std::size_t i : order) {
    std::printf("  tick %5zu  %-8s  distance %7.3f mm  depth %7.3f mm  %7.2f us\n", i,
                ticks[i].contact ? "contact" : "approach", 1e3 * ticks[i].distance, 1e3 * ticks[i].depth,
                ticks[i].least_us);
  }
}

std::size_t number(int argc, char** argv, int index, std::size_t otherwise) {
  return argc > index ? static_cast<std::size_t>(std::strtoul(argv[index], nullptr, 10)) : otherwise;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string task = argc > 1 ? argv[1] : "press";
    const scene::Setup setup = bench::subject(task, number(argc, argv, 2, 0), number(argc, argv, 3, 0));
    const haptics::SimulationWorld world = scene::make_world(setup);
    devices::ScriptedDevice device(bench::hand_path(setup));
    Times times;
    times.ticks.resize(device.last_tick(world.rate_Hz));
    const std::size_t passes = std::max<std::size_t>(1, number(argc, argv, 4, 5));
    for (std::size_t pass = 0; pass < passes; ++pass) time_pass(world, device, times);
    print("contact, every single time", times.contact_us);
    print("contact, least of passes", least_of(times.ticks, true));
    print("approach, every single time", times.approach_us);
    print("approach, least of passes", least_of(times.ticks, false));
    print("plain arithmetic, every time", times.plain_us);
    list_slowest(times.ticks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate_slow_ticks: %s\n", error.what());
    return 2;
  }
  return 0;
}
