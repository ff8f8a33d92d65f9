// Prints the standard deviation of the touch noise over distance, and single samples by their number.
#include <cmath>
#include <cstdint>
#include <iostream>

#include "palpate/touch_noise.h"

int main() {
  constexpr double kRate = 1000.0;  // Hz
  palpate::noise::NoiseSettings settings;
  settings.threshold = 5e-3;  // d0
  // Most people feel 20 mN at the fingertip. Noise above this threshold is felt as noise; weaker noise helps.
  settings.gain = palpate::noise::gain_from_threshold(20e-3, 0.6, settings.threshold);
  const palpate::noise::TouchNoise noise(settings, kRate);

  std::cout << "sigma = K / (d + d0):\n";
  for (const double distance_mm : {50.0, 20.0, 10.0, 5.0, 2.0, 0.0}) {
    std::cout << "  " << distance_mm << " mm: " << 1e3 * noise.sigma(1e-3 * distance_mm) << " mN\n";
  }

  // Ten seconds in contact: the mean is 0, the standard deviation is K / d0, and samples stay within 6 sigma.
  palpate::noise::TouchNoise::State state;
  double sum = 0.0;
  double squares = 0.0;
  constexpr std::uint64_t kTicks = 10000;
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    const double force = noise.force(state, true, 0, tick, 0.0);
    sum += force;
    squares += force * force;
  }
  const double mean = sum / kTicks;
  std::cout << "in contact, " << kTicks << " ticks: mean " << 1e3 * mean << " mN, spread "
            << 1e3 * std::sqrt(squares / kTicks - mean * mean) << " mN\n";

  // The generator is counter-based: sample n is a function of seed, hand and n.
  std::cout << "sample 123456 of hand 0: " << palpate::noise::unit_sample(settings.seed, 0, 123456) << '\n';
  return 0;
}
