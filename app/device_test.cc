// `palpate devices test`: measures what a held device can do, for about three minutes.
#include "run/devices/device_test.h"

#include <cmath>
#include <iostream>
#include <memory>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/units.h"
#include "palpate/version.h"
#include "run/devices/devices.h"
#include "run/realtime/realtime.h"

#include "app/commands.h"
#include "app/numbers.h"
#include "app/output.h"
#include "app/signals.h"

namespace palpate::app {
namespace {

using devices::DeviceTest;
using devices::Repeated;
using TestJson = nlohmann::ordered_json;

struct DeviceTestFlags {
  std::string device;
  std::string out;
  devices::DeviceTestSettings settings;
  double rate_Hz = 1000.0;
  bool yes = false;
  bool as_json = false;
};

constexpr double kMilli = 1e3;

void put(TestJson& json, const std::string& key, const std::optional<double>& value) {
  if (value) {
    json[key] = *value;
  } else {
    json[key] = nullptr;
  }
}

void put(TestJson& json, const std::string& key, const std::optional<Repeated>& value, double scale = 1.0) {
  if (value) {
    json[key] = {{"mean", value->mean * scale}, {"sd", value->sd * scale}};
  } else {
    json[key] = nullptr;
  }
}

TestJson document(const DeviceTestFlags& flags, const std::string& name, const DeviceTest& found) {
  const auto in_mm = [](std::optional<double> value) {
    if (value) *value /= kMillimetre;
    return value;
  };
  TestJson json;
  json["format"] = "palpate device test 1";
  json["device"] = flags.device;
  json["name"] = name;
  json["palpate"] = kVersion;
  json["axis"] = std::string(1, "xyz"[flags.settings.axis]);
  json["max_force_N"] = flags.settings.max_force;
  json["loop_rate_Hz"] = found.loop_rate;
  json["new_samples_per_s"] = found.sample_rate;
  json["jitter_sd_ms"] = found.jitter_sd * kMilli;
  json["longest_period_ms"] = found.longest_period * kMilli;
  json["noise_at_rest_mm"] = found.noise_at_rest / kMillimetre;
  put(json, "resolution_mm", in_mm(found.resolution));
  put(json, "friction_N", found.friction);
  put(json, "latency_ms", found.latency, kMilli);
  put(json, "moving_mass_kg", found.mass);
  put(json, "rise_ms", found.rise, kMilli);
  put(json, "overshoot", found.overshoot);
  put(json, "largest_stable_N_per_m", found.largest_stable);
  put(json, "least_oscillating_N_per_m", found.least_oscillating);
  json["unknown"] = found.unknown;
  json["failure"] = found.failure;
  return json;
}

std::string spread(const std::optional<Repeated>& value, double scale, const char* unit) {
  if (!value) return "unknown";
  constexpr double kNoSpread = 1e-9;  // of the mean; an emulated device repeats itself
  if (value->sd < kNoSpread * std::abs(value->mean)) {
    return fmt::format("{} {}", brief(value->mean * scale, 3), unit);
  }
  return fmt::format("{} +- {} {}", brief(value->mean * scale, 3), brief(value->sd * scale, 2), unit);
}

void print(const std::string& name, const DeviceTest& found) {
  std::cout << name << '\n'
            << fmt::format("  loop                     {} Hz, jitter {} ms (sd), longest period {} ms\n",
                           brief(found.loop_rate), brief(found.jitter_sd * kMilli, 2),
                           brief(found.longest_period * kMilli, 3))
            << fmt::format("  new samples              {} a second\n", brief(found.sample_rate))
            << fmt::format("  noise at rest            {} mm (sd)\n",
                           brief(found.noise_at_rest / kMillimetre, 2))
            << "  step of the position     "
            << (found.resolution ? brief(*found.resolution / kMillimetre, 3) + " mm" : "unknown") << '\n'
            << "  friction, hand included  " << spread(found.friction, 1.0, "N") << '\n'
            << "  latency, there and back  " << spread(found.latency, kMilli, "ms") << '\n'
            << "  moving mass with hand    " << spread(found.mass, 1.0, "kg") << '\n'
            << "  force step, 10 to 90 %   " << spread(found.rise, kMilli, "ms") << '\n'
            << "  overshoot                " << spread(found.overshoot, 100.0, "%") << '\n';
  std::string wall = "unknown";
  if (found.largest_stable && found.least_oscillating) {
    wall =
        fmt::format("{:.0f} N/m; oscillates at {:.0f} N/m", *found.largest_stable, *found.least_oscillating);
  } else if (found.largest_stable) {
    wall = fmt::format("at least {:.0f} N/m, the stiffest that was tried", *found.largest_stable);
  } else if (found.least_oscillating) {
    wall = fmt::format("below {:.0f} N/m, the softest that was tried", *found.least_oscillating);
  }
  std::cout << "  largest stable wall      " << wall << '\n';
  for (const std::string& text : found.unknown) std::cout << "  not known: " << text << '\n';
  if (found.friction || found.resolution) {
    std::cout << "For the stability check, in a scene:\n  [device]\n";
    if (found.friction) std::cout << "  friction_N = " << brief(found.friction->mean, 2) << '\n';
    if (found.resolution)
      std::cout << "  resolution_mm = " << brief(*found.resolution / kMillimetre, 3) << '\n';
  }
}

void check(const DeviceTestFlags& flags) {
  if (flags.rate_Hz < scene::kSlowestRate || flags.rate_Hz > scene::kFastestRate) {
    throw InputError(fmt::format("--rate-Hz {}: must be from {} to {}", shortest(flags.rate_Hz),
                                 shortest(scene::kSlowestRate), shortest(scene::kFastestRate)));
  }
  constexpr double kMostForce = 5.0;  // N
  if (flags.settings.max_force > kMostForce) {
    throw InputError(fmt::format("--max-force-N {}: must be at most {}", shortest(flags.settings.max_force),
                                 shortest(kMostForce)));
  }
}

int test(DeviceTestFlags flags) {
  check(flags);
  StopOnSignal stop;
  const devices::OpenedDevice opened = devices::open_for_test(flags.device, flags.rate_Hz);
  const bool asks = !flags.yes && opened.held_by_person;
  realtime::PlayLimits limits;
  limits.max_force = flags.settings.max_force;
  (void)realtime::request_priority(realtime::Urgency::kLoop);
  realtime::HeldPlay play(*opened.device, flags.rate_Hz, limits, realtime::PlayClock::monotonic(),
                          &stop.flag());
  flags.settings.max_force = play.max_force();
  const auto instruct = [&](const std::string& title, const std::string& what) {
    std::cerr << title << ": " << what << (asks ? " Press Enter when ready, Ctrl-D to end.\n" : "\n");
    std::string line;
    return !asks || static_cast<bool>(std::getline(std::cin, line));
  };
  const DeviceTest found = devices::test_device(play, flags.settings, instruct);
  const std::string text = json_text(document(flags, opened.name, found)) + "\n";
  write_output(flags.out, text, "--out");
  if (flags.as_json) {
    std::cout << text;
  } else {
    print(opened.name, found);
    std::cout << "written to " << flags.out << ", which you can send in\n";
  }
  if (!found.failure.empty()) std::cerr << "palpate: " << found.failure << '\n';
  return found.failure.empty() || stop.flag() ? kDone : kFault;
}

}  // namespace

void add_device_test(CLI::App& devices, int& exit_code) {
  auto flags = std::make_shared<DeviceTestFlags>();
  CLI::App* command = devices.add_subcommand(
      "test", "Measure a held device: rate, latency, resolution, friction, force step, stable stiffness");
  command
      ->add_option("device", flags->device,
                   "KIND[:PATH] as for palpate run --device; emulated: a simulated hand")
      ->required();
  command->add_option("--out", flags->out, "the file of the result, default device-test.json");
  flags->out = "device-test.json";
  add_choice<int, int>(*command, "--axis", flags->settings.axis, {{"x", 0}, {"y", 1}, {"z", 2}},
                       "axis of the device's frame that is pushed: x, y or z (default)");
  add_number(*command, "--max-force-N", flags->settings.max_force, Numbers::kPositive,
             "largest force, default 2, at most 5");
  add_number(*command, "--rate-Hz", flags->rate_Hz, Numbers::kPositive, "rate of the loop, default 1000");
  command->add_flag("--yes", flags->yes, "do not wait for Enter before each part");
  command->add_flag("--json", flags->as_json, "print the file's JSON document");
  command->footer(
      "Examples:\n  palpate devices test haply\n  palpate devices test emulated --json\n"
      "Somebody holds the grip; each part says how. A fault or a runaway ends the test at zero force.\n"
      "Exit: 0 done, 2 bad input, 3 a fault or a runaway");
  command->callback([flags, &exit_code] { exit_code = test(*flags); });
}

}  // namespace palpate::app
