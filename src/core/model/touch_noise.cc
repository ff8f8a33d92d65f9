#include "palpate/touch_noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/philox.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::noise {
namespace {

constexpr double kThousandths = 1e3;   // rates are stored in thousandths of a hertz
constexpr double kSlowestRate = 1e-3;  // Hz, the smallest stored rate above 0
constexpr double kFastestRate = 1e6;   // Hz, far above any loop rate

// Uniform in [0, 1) from the upper 53 of 64 bits.
double uniform(std::uint32_t high, std::uint32_t low) noexcept {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32) | low;
  return static_cast<double>(static_cast<std::int64_t>(bits >> 11)) * 0x1p-53;
}

std::uint64_t in_thousandths(double rate_Hz) noexcept {
  return static_cast<std::uint64_t>(rate_Hz * kThousandths + 0.5);
}

void require_positive(const char* field, double value) {
  if (!std::isfinite(value) || !(value > 0.0)) throw ParameterError(field, value, "finite and > 0");
}

}  // namespace

void validate(const NoiseSettings& settings, double loop_rate_Hz, double max_sigma) {
  if (!(loop_rate_Hz >= kSlowestRate && loop_rate_Hz <= kFastestRate)) {
    throw ParameterError("rate_Hz", loop_rate_Hz, "a loop rate >= 0.001 Hz and <= 1e6 Hz");
  }
  if (!std::isfinite(settings.gain) || !(settings.gain >= 0.0)) {
    throw ParameterError("gain_N_m", settings.gain, "finite and >= 0");
  }
  require_positive("threshold_mm", settings.threshold / kMillimetre);
  if (!(settings.gain / settings.threshold <= max_sigma)) {
    throw ParameterError("gain_N_m", settings.gain,
                         "at most " + shortest(max_sigma * settings.threshold) +
                             " N m with threshold_mm = " + shortest(settings.threshold / kMillimetre) +
                             ": sigma in contact, K/d0, is at most " + shortest(max_sigma) + " N");
  }
  if (!(settings.rate_Hz >= kSlowestRate && settings.rate_Hz <= loop_rate_Hz)) {
    throw ParameterError(
        "rate_Hz", settings.rate_Hz,
        "a noise rate >= 0.001 Hz and <= the loop's rate (" + shortest(loop_rate_Hz) + " Hz)");
  }
}

double gain_from_threshold(double user_threshold, double share, double threshold_distance) {
  require_positive("user_threshold_N", user_threshold);
  if (!(share >= 0.0 && share <= 1.0)) throw ParameterError("share_of_threshold", share, ">= 0 and <= 1");
  require_positive("threshold_mm", threshold_distance / kMillimetre);
  return share * user_threshold * threshold_distance;  // sigma = K/d_0 [Zhang 2011, eq. 2]
}

double unit_sample(std::uint64_t seed, std::uint32_t hand, std::uint64_t n) noexcept {
  const PhiloxCounter bits =
      philox4x32({static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(n >> 32), hand, 0},
                 {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
  const double u1 = uniform(bits[0], bits[1]);
  const double u2 = uniform(bits[2], bits[3]);
  const double radius = std::sqrt(-2.0 * portable::log(1.0 - u1));
  return radius * portable::cos_of_turns(u2);  // [Zhang 2011, eq. 1]
}

TouchNoise::TouchNoise(const NoiseSettings& settings, double loop_rate_Hz) : settings_(settings) {
  validate(settings, loop_rate_Hz);
  noise_rate_ = in_thousandths(settings.rate_Hz);
  loop_rate_ = in_thousandths(loop_rate_Hz);
  const std::uint64_t common = std::gcd(noise_rate_, loop_rate_);
  noise_rate_ /= common;
  loop_rate_ /= common;
  fade_step_ = std::min(1.0, 1.0 / (loop_rate_Hz * kFade));
}

double TouchNoise::sigma(double distance) const noexcept {
  return settings_.gain / (std::max(distance, 0.0) + settings_.threshold);  // [Zhang 2011, eq. 2]
}

std::uint64_t TouchNoise::sample_number(std::uint64_t tick) const noexcept {
  if (noise_rate_ == loop_rate_) return tick;  // avoids two integer divisions at the default rates
  // tick x noise_rate / loop_rate, split so that the product cannot overflow
  return tick / loop_rate_ * noise_rate_ + tick % loop_rate_ * noise_rate_ / loop_rate_;
}

double TouchNoise::force(State& state, bool enabled, std::uint32_t hand, std::uint64_t tick,
                         double distance) const noexcept {
  const double goal = enabled ? 1.0 : 0.0;
  // Within half a step counts as reached, because the summed steps miss the goal by rounding.
  if (!state.started || std::fabs(goal - state.level) < 1.5 * fade_step_) {
    state.level = goal;
  } else {
    state.level += enabled ? fade_step_ : -fade_step_;
  }
  state.started = true;
  if (state.level == 0.0) return 0.0;
  const double unit = unit_sample(settings_.seed, hand, sample_number(tick));
  return state.level * sigma(distance) * std::clamp(unit, -kBound, kBound);
}

}  // namespace palpate::noise
