#include "fit/identify/finite_result.h"

#include <cmath>

#include <fmt/core.h>

#include "palpate/error.h"

namespace palpate::identify {

void require_finite_result(const std::string& what, double value) {
  if (std::isfinite(value)) return;
  throw InputError(fmt::format(
      "the fit gave no number for the {}: look at the data for rows far from all others, and at their units",
      what));
}

}  // namespace palpate::identify
