// `palpate bench`: how fast a tick, the law both ways and the noise are on this machine.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "palpate/base/clock.h"
#include "palpate/base/text.h"
#include "palpate/contact/contact.h"
#include "palpate/devices/devices.h"
#include "palpate/haptics/simulation.h"
#include "palpate/model/layered_law.h"
#include "palpate/noise/touch_noise.h"
#include "palpate/record/assemble.h"
#include "palpate/record/machine.h"
#include "palpate/scene/load.h"

#include "app/commands.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

constexpr double kNanosecondsPerMicrosecond = 1e3;
constexpr int kPasses = 5;  // over each scene's own path, so that p99.9 stands on some ten thousand ticks

/// Times of one scene's ticks in contact.
struct TickTimes {
  std::string scene;
  std::string phase;
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
  std::vector<double> sorted_us;

  /// The smallest time that at least `share` of all do not exceed.
  [[nodiscard]] double percentile(double share) const {
    const double rank = std::ceil(share * static_cast<double>(sorted_us.size()));
    return sorted_us[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  }
};

struct Account {
  std::vector<TickTimes> ticks;
  double law_ns = 0.0;
  double inverse_ns = 0.0;
  double noise_ns = 0.0;
};

/// One pass along the path; appends the processor time of each tick in contact [us].
void time_pass(const scene::Setup& setup, const haptics::SimulationWorld& world, contact::Phase wanted,
               std::vector<double>& times_us) {
  const auto device = devices::open_device(setup, 0);
  haptics::SimulationState state(world);
  std::vector<haptics::DeviceState> samples(1);
  std::vector<haptics::ForceCommand> commands(1);
  std::vector<haptics::TickRow> rows(1);
  const std::uint64_t last = device->last_tick(setup.rate_Hz);
  for (std::uint64_t tick = 0; tick < last; ++tick) {
    samples[0] = device->read(tick, static_cast<double>(tick) / setup.rate_Hz);
    const std::int64_t begun = thread_cpu_ns();
    haptics::tick(world, state, tick, samples, commands, rows);
    const std::int64_t ended = thread_cpu_ns();
    if (rows[0].phase == static_cast<std::uint32_t>(wanted)) {
      times_us.push_back(static_cast<double>(ended - begun) / kNanosecondsPerMicrosecond);
    }
  }
}

TickTimes time_scene(const std::string& task, contact::Phase phase, Progress& bar, double share,
                     double shares) {
  scene::Request request;
  request.task = task;
  bar.update(share, "preparing the " + task + " scene");
  const scene::Setup setup = scene::load(request);
  const haptics::SimulationWorld world = record::assemble(setup);
  TickTimes times;
  times.scene = setup.name;
  times.phase = task;
  times.organ_triangles = setup.organ.triangles.size();
  for (const geometry::ToolPart& part : setup.tools[0].parts)
    times.tool_triangles += part.mesh.triangles.size();
  for (int pass = 0; pass < kPasses; ++pass) {
    bar.update(share + shares * pass / kPasses, "ticks of the " + task + " scene");
    time_pass(setup, world, phase, times.sorted_us);
  }
  if (times.sorted_us.empty())
    throw std::runtime_error("bench: the " + task + " scene never came into contact");
  std::sort(times.sorted_us.begin(), times.sorted_us.end());
  return times;
}

/// Median over batches of the processor time of one call [ns]; `call(i)` returns a number that is kept.
template <typename Call>
double time_call(Call call) {
  constexpr int kBatches = 101;
  constexpr std::uint64_t kCalls = 10'000;
  std::vector<double> batches;
  double sum = 0.0;
  for (int batch = 0; batch < kBatches; ++batch) {
    const std::int64_t begun = thread_cpu_ns();
    for (std::uint64_t i = 0; i < kCalls; ++i) sum += call(i);
    batches.push_back(static_cast<double>(thread_cpu_ns() - begun) / static_cast<double>(kCalls));
  }
  volatile double kept = sum;  // so that no call can be left out
  static_cast<void>(kept);
  std::nth_element(batches.begin(), batches.begin() + kBatches / 2, batches.end());
  return batches[kBatches / 2];
}

Account measure() {
  Account account;
  Progress bar("bench");
  account.ticks.push_back(time_scene("press", contact::Phase::kPress, bar, 0.0, 0.45));
  account.ticks.push_back(time_scene("pull", contact::Phase::kPull, bar, 0.45, 0.45));
  bar.update(0.9, "law and noise");
  const model::LayeredSpringLaw law(model::tissue_preset("gallbladder"), model::Direction::kPress, 1e-3);
  constexpr double kDeepest = 20e-3;  // m, into the fourth layer
  constexpr double kSpread = 1e-4;    // so that ten thousand calls cover all depths
  const double largest = law.force_at(kDeepest).force;
  account.law_ns = time_call(
      [&](std::uint64_t i) { return law.force_at(kDeepest * kSpread * static_cast<double>(i)).force; });
  account.inverse_ns = time_call([&](std::uint64_t i) {
    return law.deformation_under(largest * kSpread * static_cast<double>(i)).depth;
  });
  account.noise_ns = time_call([](std::uint64_t i) { return noise::unit_sample(1, 0, i); });
  return account;
}

void print_json(const Account& account) {
  nlohmann::ordered_json json;
  json["machine"] = record::machine_description();
  json["tick"] = nlohmann::ordered_json::array();
  for (const TickTimes& times : account.ticks) {
    nlohmann::ordered_json row;
    row["scene"] = times.scene;
    row["phase"] = times.phase;
    row["organ_triangles"] = times.organ_triangles;
    row["tool_triangles"] = times.tool_triangles;
    row["ticks"] = times.sorted_us.size();
    row["p50_us"] = times.percentile(0.5);
    row["p99_us"] = times.percentile(0.99);
    row["p999_us"] = times.percentile(0.999);
    row["max_us"] = times.sorted_us.back();
    json["tick"].push_back(row);
  }
  json["law_ns"] = account.law_ns;
  json["inverse_ns"] = account.inverse_ns;
  json["noise_ns"] = account.noise_ns;
  std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void print_table(const Account& account) {
  std::cout << record::machine_description() << "\n\nOne tick in contact, processor time:\n";
  std::cout << std::left << std::setw(20) << "scene" << std::right;
  for (const char* title : {"organ triangles", "tool triangles", "p50 us", "p99 us", "p99.9 us", "max us"}) {
    std::cout << std::setw(17) << title;
  }
  std::cout << '\n';
  for (const TickTimes& times : account.ticks) {
    std::cout << std::left << std::setw(20) << times.scene << std::right << std::setw(17)
              << times.organ_triangles << std::setw(17) << times.tool_triangles;
    for (const double share : {0.5, 0.99, 0.999, 1.0})
      std::cout << std::setw(17) << shortest(times.percentile(share));
    std::cout << '\n';
  }
  std::cout << "\nForce at a depth:         " << shortest(account.law_ns) << " ns\n"
            << "Depth under a force:      " << shortest(account.inverse_ns) << " ns\n"
            << "Noise sample by number:   " << shortest(account.noise_ns) << " ns\n";
}

}  // namespace

void add_bench(CLI::App& program, int& exit_code) {
  auto as_json = std::make_shared<bool>(false);
  CLI::App* command = program.add_subcommand(
      "bench", "How fast a tick, the force law and the touch noise are on this machine");
  command->add_flag("--json", *as_json, "one JSON document");
  command->footer("Example:\n  palpate bench --json > bench.json");
  command->callback([as_json, &exit_code] {
    const Account account = measure();
    if (*as_json) {
      print_json(account);
    } else {
      print_table(account);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
