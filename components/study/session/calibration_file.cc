#include <nlohmann/json.hpp>

#include "io/system/csv_table.h"
#include "io/system/input_file.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

#include "study/session/calibration.h"

namespace palpate::study {
namespace {

constexpr const char* kCalibrationFormat = "palpate calibration 1";
constexpr InputKind kCalibrationInput{"a calibration", std::uint64_t{16} << 20};
constexpr double kMicro = 1e-6;

nlohmann::json parsed(const std::filesystem::path& file, const std::string& text) {
  try {
    return parse_json(text);
  } catch (const InputError& error) {
    throw InputError(to_text(file) + ": " + error.what());
  }
}

}  // namespace

TimedSignal read_timed_signal(const std::filesystem::path& file, const std::string& column, double unit) {
  constexpr double kMilli = 1e-3;
  constexpr double kLargest = 1e6;
  CsvTable table(file, {{"time_s", false, false, true}, {"time_ms", false, false, true}, {column}}, kLargest);
  if (table.has(0) == table.has(1)) table.fail("must have one column of times: time_s or time_ms");
  TimedSignal signal;
  while (table.next_row()) {
    const double time = table.has(0) ? table.number(0) : table.number(1) * kMilli;
    if (!signal.time.empty() && time <= signal.time.back()) {
      table.fail(table.has(0) ? 0 : 1, "must be above that of the row before it");
    }
    signal.time.push_back(time);
    signal.value.push_back(table.number(2) * unit);
  }
  constexpr std::size_t kFewest = 1000;
  if (signal.time.size() < kFewest) table.fail("the table ends; must have at least 1000 rows");
  return signal;
}

void read_playback(const std::filesystem::path& file, Calibration& made) {
  const nlohmann::json document = parsed(file, InputFile(file, kCalibrationInput).read_rest());
  const JsonField json(document, to_text(file) + ": ");
  made.device = json.at("device").text();
  made.axis = static_cast<int>(json.at("axis").number(0.0, 2.0));
}

std::string calibration_json(const Calibration& made) {
  nlohmann::ordered_json json;
  json["format"] = kCalibrationFormat;
  json["device"] = made.device;
  json["unit"] = made.unit;
  json["axis"] = std::string(1, "xyz"[made.axis]);
  json["rate_Hz"] = made.rate_Hz;
  json["commanded_sd_N"] = made.sigma;
  json["band_Hz"] = {made.band.low, made.band.high};
  json["gain_per_N"] = made.gain;
  json["grip_sd"] = made.at_grip(made.sigma);
  json["measured_sd"] = made.measured_sd;
  json["coherence"] = made.coherence;
  json["least_coherence"] = made.least_coherence;
  json["sweep_to_noise"] = nullptr;
  if (made.sweep_ratio) json["sweep_to_noise"] = *made.sweep_ratio;
  json["clock_offset_s"] = made.clock_offset;
  json["clock_skew_ppm"] = made.clock_skew / kMicro;
  json["correlation_peak"] = made.match;
  json["played_sha256"] = made.played_sha256;
  json["sensor_sha256"] = made.sensor_sha256;
  json["columns"] = {"frequency_Hz", "magnitude_per_N", "phase_rad", "coherence"};
  nlohmann::ordered_json& rows = json["response"] = nlohmann::ordered_json::array();
  for (const Response& one : made.responses) {
    rows.push_back({one.frequency, one.magnitude, one.phase, one.coherence});
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Calibration read_calibration(const std::filesystem::path& file) {
  const std::string text = InputFile(file, kCalibrationInput).read_rest();
  const nlohmann::json document = parsed(file, text);
  const JsonField json(document, to_text(file) + ": ");
  if (json.at("format").text() != kCalibrationFormat) {
    json.at("format").fail("\"palpate calibration 1\", as palpate study calibrate writes it");
  }
  constexpr double kLargest = 1e9;
  Calibration made;
  made.device = json.at("device").text();
  made.unit = json.at("unit").text();
  if (made.unit != "N" && made.unit != "m/s2") json.at("unit").fail("\"N\" or \"m/s2\"");
  made.rate_Hz = json.at("rate_Hz").positive(kLargest);
  made.sigma = json.at("commanded_sd_N").positive(kLargest);
  const std::vector<JsonField> band = json.at("band_Hz").exactly(2);
  made.band = {band[0].positive(kLargest), band[1].positive(kLargest)};
  made.gain = json.at("gain_per_N").positive(kLargest);
  made.coherence = json.at("coherence").number(0.0, 1.0);
  made.least_coherence = json.at("least_coherence").number(0.0, 1.0);
  made.sweep_ratio = json.at("sweep_to_noise").optional_number();
  made.sha256 = sha256(text);
  return made;
}

}  // namespace palpate::study
