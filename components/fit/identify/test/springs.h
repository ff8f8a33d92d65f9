#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/base/random.h"
#include "palpate/identify.h"

namespace palpate::identify {

/// Two layers that are compressed one after the other.
struct Springs {
  double first = 20.0;    // N/m
  double second = 100.0;  // N/m, beyond the knot
  double knot = 4e-3;     // m
  double deepest = 8e-3;  // m
  double noise = 2e-3;    // N, standard deviation
};

/// A specimen of 40 points. @param number seed of the noise
inline Specimen springs(const Springs& of, std::uint32_t number) {
  constexpr int kPoints = 40;
  Random random(11, number, 0);
  Specimen specimen;
  specimen.name = "bent " + std::to_string(number);
  for (int i = 1; i <= kPoints; ++i) {
    const double depth = of.deepest * i / kPoints;
    const double force = of.first * std::min(depth, of.knot) + of.second * std::max(0.0, depth - of.knot);
    specimen.displacement.push_back(depth);
    specimen.force.push_back(force + of.noise * random.normal());
  }
  return specimen;
}

/// Random springs: the second 2.5 to 9 times as stiff, noise of 0.1 to 2 % of the force range.
inline Springs random_springs(std::uint32_t number) {
  Random random(12, number, 0);
  const auto between = [&random](double low, double high) { return low + random.uniform() * (high - low); };
  Springs of;
  of.deepest = between(6e-3, 16e-3);
  of.knot = between(0.2, 0.9) * of.deepest;
  of.first = between(8.0, 40.0);
  of.second = of.first * between(2.5, 9.0);
  const double range = of.first * of.knot + of.second * (of.deepest - of.knot);
  of.noise = range * std::pow(10.0, between(-3.0, -1.7));
  return of;
}

}  // namespace palpate::identify
