#pragma once
#include <cstdint>

namespace palpate::noise {

/// The touch noise's settings. SI units.
struct NoiseSettings {
  bool enabled = true;
  double gain = 5e-5;       // K [N m]; sigma in contact = K / d0
  double threshold = 5e-3;  // d0 [m], > 0
  double rate_Hz = 1000.0;  // the noise's own clock, at most the loop's rate
  std::uint64_t seed = 1;
};

/// Standard deviation [N] in contact that no settings exceed: 50 times that of the default, and above what a
/// fingertip or a hand on a stylus detects.
inline constexpr double kMaxSigma = 0.5;

/// [setup] @param max_sigma K/d0 may not exceed it [N]
/// @throws ParameterError naming gain_N_m, threshold_mm or rate_Hz (the noise's or the loop's).
void validate(const NoiseSettings& settings, double loop_rate_Hz, double max_sigma = kMaxSigma);

/// [setup] K [N m] that puts sigma in contact at `share` (0..1) of the user's own detection threshold [N].
/// @throws ParameterError naming user_threshold_N, share_of_threshold.
[[nodiscard]] double gain_from_threshold(double user_threshold, double share, double threshold_distance);

/// [rt] The unit sample n of a hand: a standard normal number, f(seed, hand, n), by Philox 4x32-10 and
/// Box-Muller [Zhang 2011, eq. 1]; every sample can be computed alone. |x| <= 8.6.
[[nodiscard]] double unit_sample(std::uint64_t seed, std::uint32_t hand, std::uint64_t n) noexcept;

/// White touch noise for one loop rate: sigma = K/(d + d0) in approach, K/d0 in contact [Zhang 2011, eq. 2].
class TouchNoise final {
 public:
  /// What one hand's noise carries from tick to tick.
  struct State {
    double level = 0.0;  // 0 off .. 1 on, moves by T/50 ms a tick
    bool started = false;
  };

  static constexpr double kBound = 6.0;   // in sigma
  static constexpr double kFade = 50e-3;  // s, when switched; none at the first tick

  /// [setup] @throws ParameterError as validate().
  TouchNoise(const NoiseSettings& settings, double loop_rate_Hz);

  /// [rt] Standard deviation [N] at distance d [m]; d <= 0 is contact.
  [[nodiscard]] double sigma(double distance) const noexcept;

  /// [rt] The noise's sample number at a loop tick: floor(tick x noise_rate / rate), in integers.
  [[nodiscard]] std::uint64_t sample_number(std::uint64_t tick) const noexcept;

  /// [rt] Signed noise force [N] of one hand at one tick; bounded at 6 sigma. `enabled` may change from tick
  /// to tick: the level then fades over 50 ms.
  [[nodiscard]] double force(State& state, bool enabled, std::uint32_t hand, std::uint64_t tick,
                             double distance) const noexcept;

  /// [rt] Another K [N m] and d0 [m], both as validate() wants them.
  void set_strength(double gain, double threshold) noexcept {
    settings_.gain = gain;
    settings_.threshold = threshold;
  }

  [[nodiscard]] const NoiseSettings& settings() const noexcept { return settings_; }

 private:
  NoiseSettings settings_;
  std::uint64_t noise_rate_;  // both in thousandths of a hertz, so that the ratio is exact in integers
  std::uint64_t loop_rate_;
  double fade_step_;
};

}  // namespace palpate::noise
