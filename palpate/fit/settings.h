#pragma once
#include <cstdint>

#include "palpate/model/tissue.h"

namespace palpate::fit {

/// What is fitted, and how its intervals are found. SI.
struct Settings {
  model::LawKind law = model::LawKind::kLayered;
  model::Direction direction = model::Direction::kPress;
  bool relaxation = false;  // as many terms as the data bear, at least one
  double period = 1e-3;     // T of the loop [s], which with t1 decides how many layers move
  double t1 = 1e-6;         // [s]
  int bootstrap = 0;        // resamples for a second kind of interval
  std::uint64_t seed = 1;
};

}  // namespace palpate::fit
