#pragma once
#include <cmath>
#include <string>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::model {

/// [setup] @param value, low, high in SI units @param unit SI value of one unit of the field
/// @throws ParameterError that names the field, the value in that unit and the range
inline void require_within(const std::string& field, double value, double low, double high, double unit) {
  if (value >= low && value <= high) return;
  const auto rounded = [unit](double limit) { return shortest(std::round(limit / unit * 1e6) / 1e6); };
  throw ParameterError(field, value / unit, "a number >= " + rounded(low) + " and <= " + rounded(high));
}

}  // namespace palpate::model
