#pragma once
#include <cstddef>

#include "palpate/identify.h"

namespace palpate::identify {

inline constexpr double kStartErrors = 4.0;  // standard errors above which a value differs from 0
inline constexpr double kCertain = 10.0;     // decrease of the Bayesian information criterion that counts

/// How a loading curve begins: what the sensor reads without contact, and where contact begins.
///
/// Two models compete for the first rows: a smooth curve (a polynomial), and a
/// straight or parabolic lead that ends at a kink, with a steeper curve beyond it. The kink needs five rows
/// before it, and the Bayesian information criterion must prefer it by kCertain. A smooth curve that falls at
/// first is no rival, since no tissue does. The kink is the one that the fewest rows show, up to a fifth of
/// the force range. Single rows far from their neighbours do not count.
struct Start {
  double force = 0.0;          // N, of the smooth curve at the first row
  double force_error = 0.0;    // N, its standard error
  double slope = 0.0;          // N/m, of the smooth curve there
  double slope_error = 0.0;    // N/m, its standard error
  double contact_error = 0.0;  // m, way to where the force rises by two standard errors
  double noise = 0.0;          // N, standard deviation

  std::size_t lead_rows = 0;  // number of rows before the kink; 0: no kink
  double kink = 0.0;          // m, its displacement
  double lead_force = 0.0;    // N, of the lead at the kink
  double lead_error = 0.0;    // N, its standard error
  double lead_slope = 0.0;    // N/m, at the kink
  double lead_curve =
      0.0;  // N/m^2, where it differs from 0 by three standard errors: half the change of the slope
  double curve_error = 0.0;  // N/m^2, the standard error of a curvature
  double kink_error = 0.0;   // m, as contact_error
};

/// [setup] Analyses the first rows of a loading curve; the order of the rows does not matter.
[[nodiscard]] Start start_of(const Specimen& loading, const Ranges& ranges);

}  // namespace palpate::identify
