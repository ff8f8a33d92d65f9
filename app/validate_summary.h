#pragma once
#include <string>
#include <vector>

#include "palpate/fit/validation.h"

namespace palpate::app {

/// Everything that `palpate validate` found.
struct Validation {
  fit::Law law;
  std::vector<fit::ForceComparison> forces;
  std::vector<fit::DeformationComparison> profiles;
  std::vector<std::string> missed;  // goals, in words
};

/// [setup] As one JSON document (docs/validation.md has its fields).
[[nodiscard]] std::string validation_json(const Validation& validation);

/// [setup] The same for people: a line a data set, then what was missed.
[[nodiscard]] std::string validation_text(const Validation& validation);

}  // namespace palpate::app
