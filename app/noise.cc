// `palpate noise`: the steady touch noise alone, one value a line.
#include <cstdint>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/touch_noise.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/numbers.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

struct NoiseFlags {
  std::string gain = shortest(noise::NoiseSettings{}.gain);
  std::string threshold = shortest(noise::NoiseSettings{}.threshold / kMillimetre);
  std::string distance;
  bool contact = false;
  std::string samples;
  std::string seed = "1";
  bool as_json = false;
};

/// What was asked for, checked, in SI.
struct NoiseRequest {
  noise::TouchNoise noise;
  double distance = 0.0;  // m, 0 in contact
  std::uint64_t samples = 0;
};

NoiseRequest read_flags(const NoiseFlags& flags) {
  noise::NoiseSettings settings;
  settings.gain = parse_not_negative("--gain-N-m", flags.gain);
  settings.threshold = parse_positive("--threshold-mm", flags.threshold) * kMillimetre;
  settings.seed = parse_whole("--seed", flags.seed);
  const double distance =
      flags.contact ? 0.0 : parse_not_negative("--distance-mm", flags.distance) * kMillimetre;
  const std::uint64_t samples = parse_whole("--samples", flags.samples);
  if (samples == 0) throw InputError("--samples 0: must be at least 1");
  return {noise::TouchNoise(settings, settings.rate_Hz), distance, samples};
}

/// Calls `take(force)` for each sample of hand 0; the noise has been on for long, so there is no fade.
template <typename Take>
void for_each_force(const NoiseRequest& request, Take take) {
  noise::TouchNoise::State state;
  for (std::uint64_t tick = 0; tick < request.samples; ++tick) {
    take(request.noise.force(state, true, 0, tick, request.distance));
  }
}

void print_lines(const NoiseRequest& request) {
  constexpr std::uint64_t kLinesAtOnce = 4096;
  const bool piped = isatty(STDOUT_FILENO) != 1;  // lines and a bar on one terminal would mix
  Progress bar("noise");
  std::string lines;
  std::uint64_t done = 0;
  const auto write = [&lines] {
    std::cout << lines << std::flush;
    lines.clear();
    if (!std::cout) throw std::runtime_error("standard output: cannot write to it any more");
  };
  for_each_force(request, [&](double force) {
    lines += shortest(force);
    lines += '\n';
    if (++done % kLinesAtOnce != 0) return;
    write();
    if (piped) bar.update(static_cast<double>(done) / static_cast<double>(request.samples), "");
  });
  write();
}

void print_json(const NoiseRequest& request, bool contact) {
  nlohmann::ordered_json json;
  json["gain_N_m"] = request.noise.settings().gain;
  json["threshold_mm"] = request.noise.settings().threshold / kMillimetre;
  json["contact"] = contact;
  if (!contact) json["distance_mm"] = request.distance / kMillimetre;
  json["seed"] = request.noise.settings().seed;
  json["sigma_N"] = request.noise.sigma(request.distance);
  nlohmann::ordered_json forces = nlohmann::ordered_json::array();
  for_each_force(request, [&forces](double force) { forces.push_back(force); });
  json["force_N"] = std::move(forces);
  std::cout << json.dump() << '\n';
}

}  // namespace

void add_noise(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<NoiseFlags>();
  CLI::App* command =
      program.add_subcommand("noise", "The steady touch noise alone, one value a line, newtons");
  command->add_option("--gain-N-m", flags->gain, "K; sigma is K/(distance + threshold) (default 5e-5)");
  command->add_option("--threshold-mm", flags->threshold, "d0 > 0 (default 5)");
  CLI::Option_group* where = command->add_option_group("where", "exactly one of these");
  where->add_option("--distance-mm", flags->distance, "distance of the tool from the tissue");
  where->add_flag("--contact", flags->contact, "in contact: sigma is K/threshold");
  where->require_option(1);
  command->add_option("--samples", flags->samples, "how many")->required();
  command->add_option("--seed", flags->seed, "a whole number (default 1)");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Example:\n  palpate noise --gain-N-m 5e-5 --threshold-mm 5 --distance-mm 3 --samples 1000 --seed 1");
  command->callback([flags, &exit_code] {
    const NoiseRequest request = read_flags(*flags);
    if (flags->as_json) {
      print_json(request, flags->contact);
    } else {
      print_lines(request);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
