#pragma once
#include <cstdint>

namespace palpate::noise {

/// Settings of the touch noise. SI units.
struct NoiseSettings {
  bool enabled = true;
  double gain = 5e-5;       // K [N m]; the standard deviation in contact is K / d0
  double threshold = 5e-3;  // d0 [m], > 0
  double rate_Hz = 1000.0;  // sample rate of the noise, at most the loop's rate
  std::uint64_t seed = 1;
};

/// Largest standard deviation [N] in contact that settings may have. It is 50 times the default and above the
/// detection threshold of a fingertip or of a hand on a stylus.
inline constexpr double kMaxSigma = 0.5;

/// [setup] Checks the settings. @param max_sigma upper bound of K/d0 [N]
/// @throws ParameterError that names gain_N_m, threshold_mm or rate_Hz (of the noise or of the loop).
void validate(const NoiseSettings& settings, double loop_rate_Hz, double max_sigma = kMaxSigma);

/// [setup] Gain K [N m] with which sigma in contact is the fraction `share` (0..1) of the user's detection
/// threshold [N]. @param threshold_distance d0 [m]
/// @throws ParameterError that names user_threshold_N or share_of_threshold.
[[nodiscard]] double gain_from_threshold(double user_threshold, double share, double threshold_distance);

/// [rt] Sample n of a hand's noise with sigma = 1: a standard normal number x with |x| <= 8.6 [Zhang 2011,
/// eq. 1]. It is a function of seed, hand and n alone (counter-based generator Philox 4x32-10 and
/// Box-Muller).
[[nodiscard]] double unit_sample(std::uint64_t seed, std::uint32_t hand, std::uint64_t n) noexcept;

/// White touch noise for one loop rate. Its standard deviation is sigma = K/(d + d0) at a distance d, and
/// K/d0 in contact [Zhang 2011, eq. 2].
class TouchNoise final {
 public:
  /// State of one hand's noise between ticks.
  struct State {
    double level = 0.0;  // 0 off .. 1 on; changes by at most T / 50 ms per tick
    bool started = false;
  };

  static constexpr double kBound = 6.0;   // bound of the force in multiples of sigma
  static constexpr double kFade = 50e-3;  // s, duration of a fade after switching; the first tick has no fade

  /// [setup] @throws ParameterError as validate().
  TouchNoise(const NoiseSettings& settings, double loop_rate_Hz);

  /// [rt] Standard deviation [N] at a distance d [m]; d <= 0 means contact.
  [[nodiscard]] double sigma(double distance) const noexcept;

  /// [rt] Number of the noise sample at a tick: floor(tick x noise_rate / loop_rate), in integer arithmetic.
  [[nodiscard]] std::uint64_t sample_number(std::uint64_t tick) const noexcept;

  /// [rt] Signed noise force [N] of one hand at one tick, bounded at 6 sigma. When `enabled` changes, the
  /// noise fades in or out over 50 ms. @param distance d [m]
  [[nodiscard]] double force(State& state, bool enabled, std::uint32_t hand, std::uint64_t tick,
                             double distance) const noexcept;

  /// [rt] Sets K [N m] and d0 [m]. Both must be valid (validate()).
  void set_strength(double gain, double threshold) noexcept {
    settings_.gain = gain;
    settings_.threshold = threshold;
  }

  [[nodiscard]] const NoiseSettings& settings() const noexcept { return settings_; }

 private:
  NoiseSettings settings_;
  std::uint64_t noise_rate_;  // mHz, like loop_rate_: the ratio is exact in integers
  std::uint64_t loop_rate_;
  double fade_step_;
};

}  // namespace palpate::noise
