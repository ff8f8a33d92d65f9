#pragma once
#include "palpate/validate.h"

namespace palpate::validate {

/// The zeros with which a measurement fits a tissue best.
struct ZerosFit {
  Zeros zeros;
  bool at_limit = false;  // the optimum lies at a bound of the search: displacements do not start near first
                          // contact
};

/// [setup] Fits first contact and sensor offset of a measurement to a fixed tissue, with the bounds, loss and
/// priors that `palpate fit` uses for these two. One thread: the same data give the same bits.
/// @throws InputError when displacement or force is constant; ParameterError as the laws do.
[[nodiscard]] ZerosFit fit_zeros(const identify::Specimen& specimen, const Law& law);

/// Errors of a law with one pair of zeros.
struct ZeroedErrors {
  Zeros zeros;
  Errors errors;
  bool at_limit = false;  // as ZerosFit::at_limit; false for given zeros
};

}  // namespace palpate::validate
