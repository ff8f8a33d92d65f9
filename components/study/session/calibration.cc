#include "study/session/calibration.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <fmt/core.h>
#include <unsupported/Eigen/FFT>

#include "core/base/random.h"
#include "core/base/statistics.h"
#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::study {
namespace {

using Complex = std::complex<double>;
using Signal = CalibrationSignal;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSegment = 1.0;  // s of a Hann window; frequencies are whole multiples of 1 Hz
constexpr double kShare = 0.45;   // of the rate: highest frequency
constexpr double kGrid = 0.5e-3;  // s, of the cross-correlation
// Of the differences that are compared: they pass what a device passes best, around 170 Hz.
constexpr double kApart = 3e-3;      // s
constexpr double kMostSkew = 2e-3;   // of a sensor's clock
constexpr double kLeastMatch = 7.0;  // peak of the cross-correlation in its RMS

// Starts of the parts of the signal [s].
constexpr double kFirstNoise = Signal::kQuiet;
constexpr double kSweepAt = kFirstNoise + Signal::kNoise;
constexpr double kSecondNoise = kSweepAt + Signal::kSweep;

/// A signal's value at a time: the last one before it (held), or the line between neighbours.
double value_at(const TimedSignal& signal, double time, bool held) {
  const auto after = std::upper_bound(signal.time.begin(), signal.time.end(), time);
  if (after == signal.time.begin() || after == signal.time.end()) return 0.0;
  const auto i = static_cast<std::size_t>(after - signal.time.begin());
  if (held) return signal.value[i - 1];
  const double share = (time - signal.time[i - 1]) / (signal.time[i] - signal.time[i - 1]);
  return signal.value[i - 1] + share * (signal.value[i] - signal.value[i - 1]);
}

/// Differences of the signal on the grid, from `begin` on: without offset, gravity and slow motion.
std::vector<double> differences(const TimedSignal& signal, double begin, double seconds, bool held) {
  std::vector<double> values;
  const auto count = static_cast<std::size_t>(seconds / kGrid);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = begin + static_cast<double>(i) * kGrid;
    const bool inside = time >= signal.time.front() && time + kApart < signal.time.back();
    values.push_back(inside ? value_at(signal, time + kApart, held) - value_at(signal, time, held) : 0.0);
  }
  return values;
}

struct Match {
  double lag = 0.0;      // s, by which `later` follows `first`
  double quality = 0.0;  // peak in RMS
};

/// The lag of the largest cross-correlation, by FFT, between its neighbours by a parabola.
Match match(const std::vector<double>& first, const std::vector<double>& later) {
  std::size_t size = 1;
  while (size < first.size() + later.size()) size *= 2;
  Eigen::FFT<double> fft;
  const auto spectrum = [&](const std::vector<double>& values) {
    std::vector<Complex> padded(size), result;
    std::copy(values.begin(), values.end(), padded.begin());
    fft.fwd(result, padded);
    return result;
  };
  std::vector<Complex> product = spectrum(later);
  const std::vector<Complex> other = spectrum(first);
  for (std::size_t i = 0; i < size; ++i) product[i] *= std::conj(other[i]);
  std::vector<Complex> lags;
  fft.inv(lags, product);
  const auto at = [&](std::size_t i) { return std::abs(lags[i % size].real()); };
  std::size_t peak = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    if (at(i) > at(peak)) peak = i;
    sum += at(i) * at(i);
  }
  const double before = at(peak + size - 1);
  const double after = at(peak + 1);
  const double bend = before - 2.0 * at(peak) + after;
  const double part = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  const double whole =
      peak < size / 2 ? static_cast<double>(peak) : static_cast<double>(peak) - static_cast<double>(size);
  const double rms = std::sqrt(sum / static_cast<double>(size));
  return {(whole + part) * kGrid, rms > 0.0 ? at(peak) / rms : 0.0};
}

/// Sums of one or more windows at whole frequencies.
struct Spectra {
  explicit Spectra(std::size_t frequencies) : xx(frequencies), yy(frequencies), xy(frequencies) {}
  std::vector<double> xx, yy;
  std::vector<Complex> xy;
  int windows = 0;

  [[nodiscard]] Complex response(std::size_t k) const { return xx[k] > 0.0 ? xy[k] / xx[k] : Complex{}; }
  [[nodiscard]] double coherence(std::size_t k) const {
    const double product = xx[k] * yy[k];
    return product > 0.0 ? std::norm(xy[k]) / product : 0.0;
  }
};

/// Fourier integrals of a windowed signal over [begin, begin + kSegment) at 0, 1, ... Hz, at the signal's own
/// times: nothing is interpolated. @param held the signal holds each value until the next (a commanded force)
std::vector<Complex> transform(const TimedSignal& signal, double begin, std::size_t frequencies, bool held) {
  std::vector<Complex> sums(frequencies);
  auto i = static_cast<std::size_t>(std::lower_bound(signal.time.begin(), signal.time.end(), begin) -
                                    signal.time.begin());
  for (; i + 1 < signal.time.size() && signal.time[i] < begin + kSegment; ++i) {
    const double step = held || i == 0 ? signal.time[i + 1] - signal.time[i]
                                       : 0.5 * (signal.time[i + 1] - signal.time[i - 1]);
    const double time = signal.time[i] - begin + (held ? 0.5 * step : 0.0);
    const double window = 0.5 - 0.5 * std::cos(kTurn * time / kSegment);
    const Complex turn = std::polar(1.0, -kTurn * time / kSegment);
    Complex term = signal.value[i] * window * step;
    for (Complex& sum : sums) {
      sum += term;
      term *= turn;
    }
  }
  if (!held || signal.time.size() < 2) return sums;
  // A held value is a rectangle of one period.
  const double period =
      (signal.time.back() - signal.time.front()) / static_cast<double>(signal.time.size() - 1);
  for (std::size_t k = 1; k < frequencies; ++k) {
    const double half = 0.5 * kTurn * static_cast<double>(k) / kSegment * period;
    sums[k] *= std::sin(half) / half;
  }
  return sums;
}

void add_windows(const TimedSignal& played, const TimedSignal& sensor, double from, double to,
                 Spectra& sums) {
  const std::size_t frequencies = sums.xx.size();
  for (double begin = from; begin + kSegment <= to + 1e-9; begin += 0.5 * kSegment, ++sums.windows) {
    const std::vector<Complex> x = transform(played, begin, frequencies, true);
    const std::vector<Complex> y = transform(sensor, begin, frequencies, false);
    for (std::size_t k = 0; k < frequencies; ++k) {
      sums.xx[k] += std::norm(x[k]);
      sums.yy[k] += std::norm(y[k]);
      sums.xy[k] += std::conj(x[k]) * y[k];
    }
  }
}

/// Lags of pieces of both noises [s], each against its middle: a clock that runs faster shifts the later
/// ones.
std::vector<std::pair<double, double>> lags_of_pieces(const TimedSignal& played, const TimedSignal& sensor,
                                                      double rough) {
  constexpr double kPiece = 2.0;   // s: a skew of 500 ppm shifts its ends by half a millisecond
  constexpr double kSlack = 0.02;  // s
  std::vector<std::pair<double, double>> lags;
  for (const double noise : {kFirstNoise, kSecondNoise}) {
    for (double begin = noise; begin + kPiece <= noise + Signal::kNoise; begin += kPiece) {
      const double room = kSlack + kMostSkew * begin;
      const double near = begin + rough - room;
      const Match found = match(differences(played, begin, kPiece, true),
                                differences(sensor, near, kPiece + 2.0 * room, false));
      lags.emplace_back(begin + 0.5 * kPiece, found.lag - room + rough);
    }
  }
  return lags;
}

/// Brings the sensor's times to the program's clock.
TimedSignal aligned(const TimedSignal& played, const TimedSignal& sensor, Calibration& found) {
  const double seconds = sensor.time.back() - sensor.time.front();
  const Match rough = match(differences(played, kFirstNoise, Signal::kNoise, true),
                            differences(sensor, sensor.time.front(), seconds, false));
  found.match = rough.quality;
  if (rough.quality < kLeastMatch) {
    throw InputError(fmt::format(
        "the sensor's record does not contain the played noise (correlation {} times its RMS, must be {} or "
        "more): is it of this playback, in the pushed direction, and sampled at 1 kHz or faster?",
        brief(rough.quality, 3), shortest(kLeastMatch)));
  }
  const double offset = sensor.time.front() + rough.lag - kFirstNoise;
  if (offset + kSecondNoise + Signal::kNoise > sensor.time.back()) {
    throw InputError("the sensor's record ends before the second noise: it must hold the whole playback");
  }
  const auto lags = lags_of_pieces(played, sensor, offset);
  // The median of the slopes and of the offsets [Theil 1950; Sen 1968]: a jerk spoils few pieces.
  std::vector<double> slopes, offsets;
  for (std::size_t i = 0; i < lags.size(); ++i) {
    for (std::size_t k = i + 1; k < lags.size(); ++k) {
      slopes.push_back((lags[k].second - lags[i].second) / (lags[k].first - lags[i].first));
    }
  }
  found.clock_skew = median(slopes);
  for (const auto& [time, lag] : lags) offsets.push_back(lag - found.clock_skew * time);
  found.clock_offset = median(offsets);
  constexpr double kMostSpread = 1e-3;  // s
  for (double& offset_of_piece : offsets) offset_of_piece -= found.clock_offset;
  if (const double spread = normalized_mad(offsets); spread > kMostSpread) {
    throw InputError(
        fmt::format("the sensor's clock cannot be aligned: the parts of its record differ by {} s, must be "
                    "at most {}: it measured too little of the noise (fix it to the grip, or play a larger "
                    "--sigma-N)",
                    brief(spread, 2), shortest(kMostSpread)));
  }
  TimedSignal result = sensor;
  for (double& time : result.time) time = (time - found.clock_offset) / (1.0 + found.clock_skew);
  return result;
}

/// Spectral density [1/Hz, one-sided] of held white noise of the variance 1.
double held_noise_density(double frequency, double rate_Hz) {
  const double half = 0.5 * kTurn * frequency / rate_Hz;
  const double held = half > 0.0 ? std::sin(half) / half : 1.0;
  return 2.0 / rate_Hz * held * held;
}

/// Squared magnitude of the response without what the sensor's own noise adds to it.
double squared_response(const Spectra& sums, std::size_t k) {
  constexpr double kIndependent = 0.95;  // of half overlapping Hann windows [Welch 1967]
  const double square = std::norm(sums.response(k));
  const double rest = sums.xx[k] > 0.0 ? sums.yy[k] / sums.xx[k] - square : 0.0;
  return std::max(0.0, square - rest / (kIndependent * sums.windows));
}

/// The sweep's response against the noise's in the band, where the sweep is well above the sensor's noise.
std::optional<double> sweep_against_noise(const Spectra& sweep, const Spectra& noise, const Band& band,
                                          double rate_Hz) {
  constexpr double kClear = 0.9;  // coherence
  double by_sweep = 0.0;
  double by_noise = 0.0;
  for (std::size_t k = 1; k < noise.xx.size(); ++k) {
    const double f = static_cast<double>(k) / kSegment;
    if (f < band.low || f > band.high || sweep.coherence(k) < kClear) continue;
    by_sweep += std::norm(sweep.response(k)) * held_noise_density(f, rate_Hz);
    by_noise += squared_response(noise, k) * held_noise_density(f, rate_Hz);
  }
  if (!(by_noise > 0.0)) return std::nullopt;
  return std::sqrt(by_sweep / by_noise);
}

double gain_of(const Spectra& sums, const Band& band, double rate_Hz) {
  double variance = 0.0;
  for (std::size_t k = 1; k < sums.xx.size(); ++k) {
    const double f = static_cast<double>(k) / kSegment;
    if (f < band.low || f > band.high) continue;
    variance += squared_response(sums, k) * held_noise_density(f, rate_Hz) / kSegment;
  }
  return std::sqrt(variance);
}

void judge(const Spectra& noise, const Spectra& sweep, Calibration& found) {
  constexpr double kHannSquares = 0.375;  // mean of the squared Hann window
  std::vector<double> coherences;
  double variance = 0.0;
  for (std::size_t k = 1; k < noise.xx.size(); ++k) {
    const double f = static_cast<double>(k) / kSegment;
    const Complex response = noise.response(k);
    found.responses.push_back({f, std::abs(response), std::arg(response), noise.coherence(k)});
    if (f < found.band.low || f > found.band.high) continue;
    coherences.push_back(noise.coherence(k));
    variance += 2.0 * noise.yy[k] / (noise.windows * kSegment * kHannSquares) / kSegment;
  }
  found.gain = gain_of(noise, found.band, found.rate_Hz);
  found.measured_sd = std::sqrt(variance);
  found.coherence = median(coherences);
  found.least_coherence = *std::min_element(coherences.begin(), coherences.end());
  found.sweep_ratio = sweep_against_noise(sweep, noise, found.band, found.rate_Hz);
}

}  // namespace

std::vector<double> CalibrationSignal::forces(double rate_Hz) const {
  std::vector<double> forces;
  Random random(seed, 0, 0);
  const double rise = std::log(kShare * rate_Hz / kLowest);
  const auto count = static_cast<std::size_t>(std::llround(kSeconds * rate_Hz));
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    double force = 0.0;
    if (t >= kSweepAt && t < kSecondNoise) {
      const double share = (t - kSweepAt) / kSweep;
      const double turns = kLowest * kSweep / rise * (std::exp(share * rise) - 1.0);
      force = std::numbers::sqrt2 * sigma * std::sin(kTurn * turns);
    } else if (t >= kFirstNoise && t < kSecondNoise + kNoise) {
      force = sigma * std::clamp(random.normal(), -kMostSigmas, kMostSigmas);
    }
    forces.push_back(force);
  }
  return forces;
}

TimedSignal play_calibration(realtime::HeldPlay& play, const CalibrationSignal& signal) {
  const std::vector<double> forces = signal.forces(play.rate_Hz());
  const auto ticks = play.play(Signal::kSeconds, [&](const realtime::PlayedTick& now) -> std::optional<Vec3> {
    const auto i = static_cast<std::size_t>(std::llround(now.time * play.rate_Hz()));
    Vec3 force = Vec3::Zero();
    force[signal.axis] = forces[std::min(i, forces.size() - 1)];
    return force;
  });
  if (ticks.empty()) throw InputError("calibration: " + play.failure());
  TimedSignal played;
  for (const realtime::PlayedTick& tick : ticks) {
    played.time.push_back(static_cast<double>(tick.begin_ns - ticks.front().begin_ns) * 1e-9);
    played.value.push_back(tick.force[signal.axis]);
  }
  return played;
}

Calibration calibrate(const TimedSignal& played, const TimedSignal& sensor, const Band& band) {
  Calibration found;
  found.band = band;
  const auto period_of = [](const TimedSignal& signal) {
    return (signal.time.back() - signal.time.front()) / static_cast<double>(signal.time.size() - 1);
  };
  if (played.time.size() < 2 || played.time.back() < Signal::kSeconds - 0.1) {
    throw InputError("the playback is incomplete: play it again");
  }
  found.rate_Hz = 1.0 / period_of(played);
  const double highest = std::min(kShare * found.rate_Hz, kShare / period_of(sensor));
  if (!(band.low < band.high && band.low >= 2.0 && band.high <= highest + 0.5)) {
    throw InputError(
        fmt::format("--band-Hz {}:{}: must rise, from 2 to at most {}, 0.45 of the loop's and of the "
                    "sensor's rate",
                    shortest(band.low), shortest(band.high), brief(highest)));
  }
  const TimedSignal measured = aligned(played, sensor, found);
  const auto frequencies = static_cast<std::size_t>(highest * kSegment) + 1;
  Spectra noise(frequencies), sweep(frequencies);
  // Not the first half second of a noise: the device is still settling.
  add_windows(played, measured, kFirstNoise + 0.5, kSweepAt, noise);
  add_windows(played, measured, kSecondNoise + 0.5, kSecondNoise + Signal::kNoise, noise);
  add_windows(played, measured, kSweepAt, kSecondNoise, sweep);
  double square = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < played.time.size(); ++i) {
    if (played.time[i] < kFirstNoise || played.time[i] >= kSweepAt) continue;
    square += played.value[i] * played.value[i];
    ++count;
  }
  found.sigma = std::sqrt(square / static_cast<double>(std::max<std::size_t>(count, 1)));
  judge(noise, sweep, found);
  return found;
}

std::string describe(const Calibration& calibration) {
  return fmt::format("{} {} at the grip for 1 N commanded, {} to {} Hz, coherence {}, {}",
                     brief(calibration.gain, 3), calibration.unit, shortest(calibration.band.low),
                     shortest(calibration.band.high), brief(calibration.coherence, 3), calibration.device);
}

}  // namespace palpate::study
