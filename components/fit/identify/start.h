#pragma once
#include <cstddef>

#include "palpate/identify.h"

namespace palpate::identify {

/// How a loading curve begins: what the sensor reads without contact, and where contact begins.
///
/// Two models compete for the rows up to a fifth of the force range: a smooth curve (a polynomial), and a
/// straight lead that ends at a kink, with a steeper curve beyond it. The kink needs five rows before it, and
/// Bayes's criterion must prefer it clearly. A smooth curve that falls at first is no rival, since no tissue
/// does. Single rows far from their neighbours do not count.
struct Start {
  bool has_kink = false;
  std::size_t rows = 0;        // number of rows before the kink
  double at = 0.0;             // m, displacement of the kink; without a kink of the first row
  double force = 0.0;          // N, reading there
  double force_error = 0.0;    // N, its standard error
  double slope = 0.0;          // N/m, of the lead; without a kink at the first row. 0: not different from 0
  double contact_error = 0.0;  // m, way to where the force rises by two standard errors (95 %)
  double noise = 0.0;          // N, standard deviation
};

/// [setup] Analyses the first rows of a loading curve; the order of the rows does not matter.
[[nodiscard]] Start start_of(const Specimen& loading, const Ranges& ranges);

}  // namespace palpate::identify
