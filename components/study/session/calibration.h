#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "run/realtime/held_play.h"

namespace palpate::study {

/// The signal that a calibration plays: white noise, a sine sweep, white noise again.
struct CalibrationSignal {
  double sigma = 0.05;  // N, standard deviation of the noise; the sweep has the same RMS
  int axis = 2;         // of the device's frame: 0 x, 1 y, 2 z
  std::uint64_t seed = 1;

  static constexpr double kQuiet = 1.0;   // s, before and after
  static constexpr double kNoise = 15.0;  // s, twice
  static constexpr double kSweep = 20.0;  // s
  static constexpr double kLowest = 5.0;  // Hz; the sweep ends at 0.45 of the rate
  static constexpr double kSeconds = 2.0 * kQuiet + 2.0 * kNoise + kSweep;
  static constexpr double kMostSigmas = 4.0;  // the noise is cut there

  /// [any] Force [N] of a tick, in order. @param rate_Hz of the loop
  [[nodiscard]] std::vector<double> forces(double rate_Hz) const;
};

/// A force or an acceleration over time, at increasing times.
struct TimedSignal {
  std::vector<double> time;   // s
  std::vector<double> value;  // N, or the sensor's unit
};

/// [setup] Plays the signal through the gate. @return written force against the time of its tick @throws
/// InputError with the reason when the playback ended early
[[nodiscard]] TimedSignal play_calibration(realtime::HeldPlay& play, const CalibrationSignal& signal);

/// Band [Hz] in which the standard deviation at the grip is taken.
struct Band {
  double low = 20.0;
  double high = 450.0;
};

/// One frequency of a transfer function.
struct Response {
  double frequency = 0.0;  // Hz
  double magnitude = 0.0;  // sensor's unit per N
  double phase = 0.0;      // rad, without the delay, which the sensor's clock hides
  double coherence = 0.0;  // 0..1
};

/// What the grip really gets for a commanded force.
struct Calibration {
  std::string device;
  std::string unit;  // of the sensor: "N" or "m/s2"
  int axis = 2;
  double rate_Hz = 1000.0;
  double sigma = 0.0;  // N, commanded
  Band band;
  std::vector<Response> responses;
  double gain = 0.0;         // unit per N: sd at the grip in the band for white noise of 1 N
  double measured_sd = 0.0;  // unit, of the sensor in the band during the noise, its own noise included
  double coherence = 0.0;    // median in the band
  double least_coherence = 0.0;
  // Response to the sweep / to the noise, 1 for a linear device; empty: the sensor's noise hides the sweep
  std::optional<double> sweep_ratio;
  double clock_offset = 0.0;  // s, of the sensor's clock
  double clock_skew = 0.0;    // its rate / the program's - 1
  double match = 0.0;         // peak of the cross-correlation / its RMS
  std::string played_sha256, sensor_sha256;
  std::string sha256;  // of the calibration's file; empty before it is written

  /// [any] sd at the grip for a commanded sd [N], and the reverse.
  [[nodiscard]] double at_grip(double commanded) const noexcept { return gain * commanded; }
  [[nodiscard]] double command_for(double wanted) const noexcept { return wanted / gain; }
};

/// [setup] Compares what was played with what a sensor measured; fills all but names and hashes.
/// @throws InputError when the record does not contain the played signal
[[nodiscard]] Calibration calibrate(const TimedSignal& played, const TimedSignal& sensor, const Band& band);

/// [setup] Reads a CSV with `time_s` (or time_ms) and one column force_N, force_mN, acceleration_m_s2,
/// acceleration_g or played.csv's force_N. @param column, unit name of the column and SI unit of a value
[[nodiscard]] TimedSignal read_timed_signal(const std::filesystem::path& file, const std::string& column,
                                            double unit);

/// [setup] Reads the device's name and the axis of a playback: {"device": TEXT, "axis": 0 to 2}.
void read_playback(const std::filesystem::path& file, Calibration& made);

/// [setup] The calibration as a JSON document, and back. @throws InputError
[[nodiscard]] std::string calibration_json(const Calibration& calibration);
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);

/// [any] "0.42 m/s2 at the grip for 1 N commanded, 20 to 450 Hz, coherence 0.98, haply".
[[nodiscard]] std::string describe(const Calibration& calibration);

}  // namespace palpate::study
