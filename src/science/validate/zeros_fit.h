#pragma once
#include "palpate/validate.h"

namespace palpate::validate {

/// The zeros that a measurement fits a tissue best with.
struct ZerosFit {
  Zeros zeros;
  bool at_limit = false;  // the best lies where the search ends: the data begin elsewhere
};

/// [setup] First contact and sensor offset with which a tissue, as it is, leaves the least of a measurement:
/// the same search as that of `palpate fit` for these two, over the same bounds, with the same loss (outliers
/// hardly count) and the same knowledge of where zeros usually are. One thread: the same data give the same
/// bits.
/// @throws InputError when displacement or force never change; ParameterError as the laws do.
[[nodiscard]] ZerosFit fit_zeros(const identify::Specimen& specimen, const Law& law);

/// What a law leaves of a measurement with one pair of zeros.
struct ZeroedErrors {
  Zeros zeros;
  Errors errors;
  bool at_limit = false;  // as ZerosFit's; false of zeros that were given
};

}  // namespace palpate::validate
