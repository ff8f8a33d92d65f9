// `palpate study calibrate`: what a commanded noise is at the grip.
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/input_file.h"
#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "palpate/error.h"
#include "run/devices/devices.h"
#include "run/realtime/realtime.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/signals.h"
#include "study/commands/study_commands.h"
#include "study/report/study_report_sections.h"
#include "study/session/calibration.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct CalibrateFlags {
  std::string folder;
  std::string device;
  std::string sensor;
  std::string unit;
  std::string band;
  study::CalibrationSignal signal;
  double rate_Hz = 1000.0;
  std::optional<double> want;
  bool as_json = false;
};

/// A unit of the sensor, the column that holds it, and its size.
struct SensorUnit {
  const char* flag;
  const char* column;
  const char* si;
  double size;
};
constexpr std::array<SensorUnit, 4> kUnits{{{"N", "force_N", "N", 1.0},
                                            {"mN", "force_mN", "N", 1e-3},
                                            {"m/s2", "acceleration_m_s2", "m/s2", 1.0},
                                            {"g", "acceleration_g", "m/s2", 9.80665}}};
constexpr InputKind kSignalInput{"a signal", std::uint64_t{1} << 30};

const SensorUnit& unit_of(const std::string& flag) {
  std::string names;
  for (const SensorUnit& unit : kUnits) {
    if (flag == unit.flag) return unit;
    names += (names.empty() ? "" : ", ") + std::string(unit.flag) + " (column " + unit.column + ")";
  }
  throw InputError("--unit " + (flag.empty() ? "is missing" : flag) +
                   ": must be the sensor's unit: " + names);
}

std::string hash_of(const fs::path& file) { return sha256(InputFile(file, kSignalInput).read_rest()); }

int play_for_sensor(const CalibrateFlags& flags) {
  constexpr double kMostSigma = 0.3;  // N
  if (flags.signal.sigma > kMostSigma) {
    throw InputError(
        fmt::format("--sigma-N {}: must be at most {}", shortest(flags.signal.sigma), shortest(kMostSigma)));
  }
  if (flags.rate_Hz < scene::kSlowestRate || flags.rate_Hz > scene::kFastestRate) {
    throw InputError(fmt::format("--rate-Hz {}: must be from {} to {}", shortest(flags.rate_Hz),
                                 shortest(scene::kSlowestRate), shortest(scene::kFastestRate)));
  }
  const StopOnSignal stop;
  const devices::OpenedDevice opened = devices::open_for_test(flags.device, flags.rate_Hz);
  realtime::PlayLimits limits;
  limits.max_force = (flags.signal.kMostSigmas + 0.5) * flags.signal.sigma;
  std::cerr << fmt::format(
      "Start the sensor's recording, hold the grip as in the study, and stay still for {} s: noise, a tone "
      "that rises, noise.{}\n",
      shortest(flags.signal.kSeconds), opened.held_by_person ? " Press Enter to begin." : "");
  std::string line;
  if (opened.held_by_person && !std::getline(std::cin, line)) return kDone;
  static_cast<void>(realtime::request_priority(realtime::Urgency::kLoop));
  realtime::HeldPlay play(*opened.device, flags.rate_Hz, limits, realtime::PlayClock::monotonic(),
                          &stop.flag());
  study::TimedSignal played;
  try {
    played = study::play_calibration(play, flags.signal);
  } catch (const InputError& error) {
    std::cerr << "palpate: " << error.what() << '\n';
    return stop.flag() ? kDone : kFault;
  }
  std::string csv =
      fmt::format("# palpate study calibrate --device {} --sigma-N {} axis {}\n", one_line(opened.name),
                  shortest(flags.signal.sigma), "xyz"[flags.signal.axis]);
  csv += "time_s,force_N\n";
  for (std::size_t i = 0; i < played.time.size(); ++i) {
    csv += shortest(played.time[i]) + "," + shortest(played.value[i]) + "\n";
  }
  std::error_code ignored;
  fs::create_directories(flags.folder, ignored);
  const fs::path folder = flags.folder;
  nlohmann::ordered_json about{{"device", opened.name}, {"axis", flags.signal.axis}};
  write_output(folder / "played.json", about.dump() + "\n");
  write_output(folder / "played.csv", csv);
  std::cout << fmt::format(
      "{}: {} s played, sd {} N\n\nNext, with the sensor's CSV (time_s and force_N or acceleration_m_s2, 1 "
      "kHz or faster):\n  palpate study calibrate {} --sensor grip.csv --unit m/s2\n",
      (folder / "played.csv").string(), shortest(flags.signal.kSeconds), shortest(flags.signal.sigma),
      flags.folder);
  return kDone;
}

study::Band band_of(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t colon = text.find(':');
  const auto low = palpate::parse_number(text.substr(0, colon));
  const auto high = colon == std::string::npos ? std::nullopt : palpate::parse_number(text.substr(colon + 1));
  if (!low || !high) throw InputError("--band-Hz " + text + ": must be LOW:HIGH, such as 20:450");
  return {*low, *high};
}

void print_calibration(const study::Calibration& made, const fs::path& file,
                       const std::optional<double>& want) {
  std::cout
      << fmt::format("{}\n", study::describe(made))
      << fmt::format("  commanded noise          {} N (sd)\n", brief(made.sigma))
      << fmt::format("  at the grip, in the band {} {} (sd); measured with the sensor's own noise: {}\n",
                     brief(made.at_grip(made.sigma)), made.unit, brief(made.measured_sd))
      << fmt::format("  coherence in the band    {} (median), {} (least)\n", brief(made.coherence, 3),
                     brief(made.least_coherence, 3))
      << fmt::format("  sweep against noise      {} (1: the device is linear)\n",
                     made.sweep_ratio ? brief(*made.sweep_ratio, 3) : "unknown, hidden by the sensor's noise")
      << fmt::format("  sensor's clock           {} s later, {} ppm {}\n", brief(made.clock_offset),
                     brief(std::abs(made.clock_skew) * 1e6, 3), made.clock_skew < 0.0 ? "slower" : "faster");
  if (want) {
    std::cout << fmt::format("For {} {} at the grip command {} N\n", shortest(*want), made.unit,
                             brief(made.command_for(*want)));
  }
  constexpr double kLeastCoherence = 0.8;
  if (made.coherence < kLeastCoherence) {
    std::cout
        << "hint: a coherence below 0.8: much of what the sensor measured was not the noise; hold still, fix "
           "the sensor, or play a larger --sigma-N\n";
  }
  std::cout << fmt::format(
      "{}, with a plot in calibration.svg. Name it in the study file: [study] calibration = \"{}\"\n",
      file.string(), file.filename().string());
}

int compare_with_sensor(const CalibrateFlags& flags) {
  const SensorUnit& unit = unit_of(flags.unit);
  const fs::path folder = flags.folder;
  const study::TimedSignal played = study::read_timed_signal(folder / "played.csv", "force_N", 1.0);
  const study::TimedSignal sensor = study::read_timed_signal(flags.sensor, unit.column, unit.size);
  study::Calibration made = study::calibrate(played, sensor, band_of(flags.band));
  study::read_playback(folder / "played.json", made);
  made.unit = unit.si;
  made.played_sha256 = hash_of(folder / "played.csv");
  made.sensor_sha256 = hash_of(flags.sensor);
  const std::string json = study::calibration_json(made);
  write_output(folder / "calibration.json", json);
  const report::Figure figure = report::draw_calibration(made, folder / "calibration.svg");
  if (!figure.missing.empty()) report_message(figure.missing);
  if (flags.as_json) {
    std::cout << json;
  } else {
    print_calibration(made, folder / "calibration.json", flags.want);
  }
  return kDone;
}

int run_calibrate(const CalibrateFlags& flags) {
  if (flags.device.empty() == flags.sensor.empty()) {
    throw InputError(
        "palpate study calibrate: must have one of --device KIND (plays) and --sensor FILE.csv (compares)");
  }
  return flags.sensor.empty() ? play_for_sensor(flags) : compare_with_sensor(flags);
}

}  // namespace

void add_study_calibrate(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<CalibrateFlags>();
  CLI::App* command = study.add_subcommand(
      "calibrate", "What a commanded noise is at the grip: play it, then compare a sensor");
  command->add_option("folder", flags->folder, "the folder of the calibration")->required();
  command->add_option("--device", flags->device, "play noise and a sweep through this device; KIND[:PATH]");
  command->add_option("--sensor", flags->sensor, "CSV of the accelerometer or load cell on the grip");
  command->add_option("--unit", flags->unit,
                      "of the sensor: N (column force_N), mN (force_mN), m/s2 (acceleration_m_s2), g "
                      "(acceleration_g); times in time_s or time_ms, by any clock");
  command->add_option("--band-Hz", flags->band, "band of the standard deviation, LOW:HIGH, default 20:450");
  add_number(*command, "--want", flags->want, Numbers::kPositive,
             "print the commanded level for this sd at the grip, in N or m/s2");
  add_number(*command, "--sigma-N", flags->signal.sigma, Numbers::kPositive,
             "standard deviation of the played noise, default 0.05, at most 0.3");
  add_choice<int, int>(*command, "--axis", flags->signal.axis, {{"x", 0}, {"y", 1}, {"z", 2}},
                       "axis of the device's frame: x, y or z (default)");
  add_number(*command, "--rate-Hz", flags->rate_Hz, Numbers::kPositive, "rate of the loop, default 1000");
  command->add_flag("--json", flags->as_json, "print the calibration's JSON document");
  command->footer(
      "Examples:\n  palpate study calibrate grip --device haply\n"
      "  palpate study calibrate grip --sensor grip.csv --unit m/s2 --want 0.5\n"
      "Exit: 0 done, 2 bad input, 3 a fault or a runaway of the device");
  command->callback([flags, &exit_code] { exit_code = run_calibrate(*flags); });
}

}  // namespace palpate::app
