#include "study/session/calibration.h"

#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"
#include "run/devices/devices.h"

#include "study/session/folder.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kCornerHz = 120.0;  // of both poles of the device
constexpr double kFilterGain = 0.8;

/// Two first-order low-pass filters after each other, exactly, for a force that is held between ticks.
class TwoPoles {
 public:
  /// Moves by `step` [s] under the force.
  void advance(double force, double step) {
    const double rate = 2.0 * std::numbers::pi * kCornerHz;
    const double decay = std::exp(-rate * step);
    // x' = r (u - x), y' = r (x - y): x - u = a decay, y - u = (b + a r t) decay.
    const double a = first_ - force;
    const double b = second_ - force;
    first_ = force + a * decay;
    second_ = force + (b + a * rate * step) * decay;
  }
  [[nodiscard]] double output() const { return kFilterGain * second_; }
  [[nodiscard]] static double magnitude(double frequency) {
    return kFilterGain / (1.0 + frequency * frequency / (kCornerHz * kCornerHz));
  }

 private:
  double first_ = 0.0, second_ = 0.0;
};

TimedSignal played_signal(double sigma = 0.05) {
  TimedSignal played;
  CalibrationSignal signal;
  signal.sigma = sigma;
  played.value = signal.forces(1000.0);
  for (std::size_t i = 0; i < played.value.size(); ++i) {
    played.time.push_back(static_cast<double>(i) * 1e-3);
  }
  return played;
}

/// A sensor whose clock is `offset` later and faster by `skew`, with white noise and a constant part.
TimedSignal sensor_of(const TimedSignal& played, double rate_Hz, double offset, double skew, double noise) {
  TimedSignal sensor;
  TwoPoles device;
  Random random(7, 0, 0);
  double now = -1.5;  // s, program's time; the recording began before the playback
  std::size_t tick = 0;
  const double step = 1.0 / rate_Hz / (1.0 + skew);
  const auto force = [&] { return tick == 0 ? 0.0 : played.value[tick - 1]; };
  for (std::size_t i = 0; now < played.time.back() + 1.0; ++i) {
    const double next = -1.5 + static_cast<double>(i) * step;
    while (tick < played.time.size() && played.time[tick] <= next) {
      device.advance(force(), played.time[tick] - now);
      now = played.time[tick++];
    }
    device.advance(force(), next - now);
    now = next;
    sensor.time.push_back(offset + next * (1.0 + skew));
    sensor.value.push_back(9.81 + device.output() + noise * random.normal());
  }
  return sensor;
}

/// sd at the grip for white noise of 1 N: the integral of the filter's response over the held noise's
/// density.
double expected_gain(const Band& band) {
  double variance = 0.0;
  constexpr double kStep = 0.01;  // Hz
  for (double f = band.low - 0.5; f < band.high + 0.5; f += kStep) {
    const double x = std::numbers::pi * f / 1000.0;
    const double held = std::sin(x) / x;
    variance += std::pow(TwoPoles::magnitude(f), 2) * 2.0 / 1000.0 * held * held * kStep;
  }
  return std::sqrt(variance);
}

TEST(Calibration, RecoversAKnownFilterWithin3PercentWhateverTheSensorsClock) {
  const TimedSignal played = played_signal();
  struct Sensor {
    double rate, offset, skew, noise;
  };
  for (const Sensor& one : {Sensor{5000.0, 123.456, 40e-6, 0.002}, Sensor{2000.0, -3.2, -300e-6, 0.0},
                            Sensor{3200.0, 0.0, 0.0, 0.01}}) {
    const TimedSignal sensor = sensor_of(played, one.rate, one.offset, one.skew, one.noise);
    const Calibration found = calibrate(played, sensor, Band{});
    EXPECT_NEAR(found.gain, expected_gain(found.band), 0.03 * expected_gain(found.band));
    ASSERT_TRUE(found.sweep_ratio.has_value());
    EXPECT_NEAR(*found.sweep_ratio, 1.0, 0.03);
    EXPECT_NEAR(found.clock_skew, one.skew, 5e-6);
    EXPECT_NEAR(found.clock_offset, one.offset, 5e-3);  // the filter's own delay is part of it
    EXPECT_NEAR(found.sigma, 0.05, 0.001);
    for (const Response& response : found.responses) {
      if (response.frequency < 20.0 || response.frequency > 200.0 || one.noise > 0.005) continue;
      EXPECT_NEAR(response.magnitude, TwoPoles::magnitude(response.frequency),
                  0.03 * TwoPoles::magnitude(response.frequency))
          << response.frequency << " Hz, sensor at " << one.rate;
    }
  }
}

TEST(Calibration, ItsLevelForAWantedOneIsTheInverseOfItsGain) {
  Calibration made;
  made.gain = 0.25;
  EXPECT_DOUBLE_EQ(made.at_grip(0.1), 0.025);
  EXPECT_DOUBLE_EQ(made.command_for(0.025), 0.1);
}

TEST(Calibration, TheCoherenceFallsWithTheSensorsNoiseAndTheGainDoesNotRise) {
  const TimedSignal played = played_signal();
  const Calibration clean = calibrate(played, sensor_of(played, 2000.0, 0.0, 0.0, 0.0), Band{});
  const Calibration noisy = calibrate(played, sensor_of(played, 2000.0, 0.0, 0.0, 0.05), Band{});
  EXPECT_GT(clean.coherence, 0.98);
  EXPECT_LT(noisy.coherence, 0.8);
  EXPECT_NEAR(noisy.gain, clean.gain, 0.05 * clean.gain);
  EXPECT_GT(noisy.measured_sd, 1.2 * noisy.at_grip(noisy.sigma));
}

TEST(Calibration, RefusesARecordOfSomethingElse) {
  const TimedSignal played = played_signal();
  TimedSignal other = sensor_of(played, 2000.0, 0.0, 0.0, 0.0);
  Random random(9, 0, 0);
  for (double& value : other.value) value = random.normal();
  EXPECT_THAT(error_of([&] { static_cast<void>(calibrate(played, other, Band{})); }),
              HasSubstr("does not contain the played noise"));
  EXPECT_THAT(error_of([&] {
                static_cast<void>(calibrate(played, played, Band{20.0, 900.0}));
              }),
              HasSubstr("--band-Hz"));
}

TEST(Calibration, TheWhiteNoiseHasItsStandardDeviationAndStaysBelowFourOfThem) {
  CalibrationSignal signal;
  const std::vector<double> forces = signal.forces(1000.0);
  for (const double force : forces) EXPECT_LE(std::abs(force), 4.0 * signal.sigma);
  EXPECT_EQ(forces.front(), 0.0);
  EXPECT_EQ(forces.back(), 0.0);
}

TEST(Calibration, PlaysThroughAnEmulatedDeviceWithoutChange) {
  const devices::OpenedDevice opened = devices::open_for_test("emulated", 1000.0);
  const auto now = std::make_shared<std::int64_t>(0);
  const realtime::PlayClock clock{[now] { return *now; }, [now](std::int64_t deadline) { *now = deadline; },
                                  false};
  realtime::HeldPlay play(*opened.device, 1000.0, {}, clock);
  const CalibrationSignal signal;
  const TimedSignal played = play_calibration(play, signal);
  EXPECT_EQ(played.value, signal.forces(1000.0));
}

TEST(Calibration, ReadsItsOwnFileAndAStudyNamesIt) {
  const TimedSignal played = played_signal();
  Calibration made = calibrate(played, sensor_of(played, 2000.0, 0.0, 0.0, 0.0), Band{});
  made.device = "emulated";
  made.unit = "N";
  const fs::path folder = fs::path(testing::TempDir()) / "calibration_test";
  fs::create_directories(folder);
  std::ofstream(folder / "calibration.json") << calibration_json(made);
  const Calibration read = read_calibration(folder / "calibration.json");
  EXPECT_DOUBLE_EQ(read.gain, made.gain);
  EXPECT_THAT(describe(read), HasSubstr("N at the grip for 1 N commanded, 20 to 450 Hz"));
  const std::string text = replaced(kStudyText, "[study]", "[study]\ncalibration = \"calibration.json\"");
  const Study study = parse_study(text, folder / "s.toml");
  ASSERT_TRUE(study.calibration.has_value());
  EXPECT_EQ(study.calibration->sha256.size(), 64U);
  EXPECT_THAT(error_of([&] { static_cast<void>(parse_study(text, folder / "none" / "s.toml")); }),
              HasSubstr("calibration.json"));
}

}  // namespace
}  // namespace palpate::study
