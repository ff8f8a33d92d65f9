// `palpate noise`: prints samples of the steady touch noise [N], one per line.
#include <cstdint>
#include <iostream>
#include <memory>
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
#include "app/output.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

struct NoiseFlags {
  noise::NoiseSettings settings;
  double distance = 0.0;  // m; 0 in contact
  bool contact = false;
  std::uint64_t samples = 0;
  bool as_json = false;
};

/// Calls `take(force)` with each sample [N] of hand 0, until it returns false. The noise is steady: it does
/// not fade in.
template <typename Take>
void for_each_force(const NoiseFlags& flags, Take take) {
  const noise::TouchNoise noise(flags.settings, flags.settings.rate_Hz);
  noise::TouchNoise::State state;
  for (std::uint64_t tick = 0; tick < flags.samples; ++tick) {
    if (!take(noise.force(state, true, 0, tick, flags.distance))) return;
  }
}

void print_lines(const NoiseFlags& flags) {
  constexpr std::uint64_t kLinesAtOnce = 4096;
  const bool piped = !is_terminal(STDOUT_FILENO);  // a progress bar would mix with the lines on a terminal
  Progress bar("noise");
  std::string lines;
  std::uint64_t done = 0;
  const auto write = [&lines] {
    std::cout << lines << std::flush;
    lines.clear();
    return static_cast<bool>(std::cout);
  };
  for_each_force(flags, [&](double force) {
    lines += shortest(force);
    lines += '\n';
    if (++done % kLinesAtOnce != 0) return true;
    if (piped) bar.update(static_cast<double>(done) / static_cast<double>(flags.samples), "");
    return write();
  });
  write();
}

void print_json(const NoiseFlags& flags) {
  nlohmann::ordered_json json;
  json["gain_N_m"] = flags.settings.gain;
  json["threshold_mm"] = flags.settings.threshold / kMillimetre;
  json["contact"] = flags.contact;
  if (!flags.contact) json["distance_mm"] = flags.distance / kMillimetre;
  json["seed"] = flags.settings.seed;
  json["sigma_N"] = noise::TouchNoise(flags.settings, flags.settings.rate_Hz).sigma(flags.distance);
  nlohmann::ordered_json forces = nlohmann::ordered_json::array();
  for_each_force(flags, [&forces](double force) {
    forces.push_back(force);
    return true;
  });
  json["force_N"] = std::move(forces);
  std::cout << json_text(json, -1) << '\n';
}

}  // namespace

void add_noise(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<NoiseFlags>();
  CLI::App* command =
      program.add_subcommand("noise", "Print samples of the steady touch noise, one per line, newtons");
  add_number(*command, "--gain-N-m", flags->settings.gain, Numbers::kNotNegative,
             "gain K; sigma is K/(distance + threshold) (default 5e-5)");
  add_number(*command, "--threshold-mm", flags->settings.threshold, Numbers::kPositive,
             "distance threshold d0 > 0 (default 5)", kMillimetre);
  CLI::Option_group* where = command->add_option_group("where", "exactly one of these");
  add_number(*where, "--distance-mm", flags->distance, Numbers::kNotNegative,
             "distance of the tool from the tissue", kMillimetre);
  where->add_flag("--contact", flags->contact, "in contact: sigma is K/threshold");
  where->require_option(1);
  add_whole(*command, "--samples", flags->samples, "number of samples")->required();
  add_whole(*command, "--seed", flags->settings.seed, "seed of the random numbers (default 1)");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Example:\n  palpate noise --gain-N-m 5e-5 --threshold-mm 5 --distance-mm 3 --samples 1000 --seed 1");
  command->callback([flags, &exit_code] {
    if (flags->samples == 0) throw InputError("--samples 0: must be at least 1");
    if (flags->as_json) {
      print_json(*flags);
    } else {
      print_lines(*flags);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app
