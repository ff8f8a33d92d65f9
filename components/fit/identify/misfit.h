#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"

#include "fit/identify/local_optima.h"

namespace palpate::identify {

/// What a fit leaves that noise does not explain, in words.
struct Misfit {
  std::vector<std::string> warnings;
  std::string poor;  // why no tissue may come from the fit; empty: one may
};

/// [setup] Compares a fit with the measured curve where a simulation needs it, in the deeper half of its
/// depth: the means of neighbours against the fitted force, and the place from which the force rises against
/// the fitted first contact. A difference over kPoorFit of the force there is poor. Where the law does not
/// follow the curve, the other law is fitted too, and a warning says which is nearer.
[[nodiscard]] Misfit misfit_of(const LocalOptima& optima, const SpecimenFit& fit);

}  // namespace palpate::identify
