#pragma once
#include <cmath>
#include <cstdint>

#include "core/base/random.h"
#include "palpate/identify.h"
#include "palpate/spring_law.h"

#include "fit/identify/least_squares.h"

namespace palpate::identify {

/// A tissue of 0.12 (exp(0.25 d) - 1) N at a depth of d mm.
inline double exponential(double depth) { return depth > 0.0 ? 0.12 * (std::exp(250.0 * depth) - 1.0) : 0.0; }

inline constexpr double kAtTenMillimetres = 1.34190;  // N: 0.12 (exp(2.5) - 1)

/// What differs from a tared sensor and a press that begins at contact.
struct Fault {
  double lead = 0.0;   // m of motion before contact
  double zero = 0.0;   // N
  double slope = 0.0;  // N/m of the sensor's reading over displacement
};

/// Rows every 0.1 mm to 12 mm of depth, with 3 mN of noise.
inline Specimen pressed(const Fault& fault, std::uint32_t number = 0) {
  Random random(61, number, 0);
  Specimen specimen;
  specimen.name = "pressed";
  for (int i = 0; 1e-4 * i < fault.lead + 12.00001e-3; ++i) {
    const double at = 1e-4 * i;
    specimen.displacement.push_back(at);
    specimen.force.push_back(exponential(at - fault.lead) + fault.zero + fault.slope * at +
                             3e-3 * random.normal());
  }
  return specimen;
}

inline Settings smooth() {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  return settings;
}

/// Force of the fitted tissue at 10 mm.
inline double force_at_ten(const SpecimenFit& fit) {
  const model::TissueParameters tissue = tissue_of(fit.shared, smooth());  // the same for both laws
  if (fit.law == model::LawKind::kSmooth)
    return model::SmoothSpringLaw(tissue, model::Direction::kPress, 1e-3).force_at(10e-3).force;
  return model::LayeredSpringLaw(tissue, model::Direction::kPress, 1e-3).force_at(10e-3).force;
}

}  // namespace palpate::identify
