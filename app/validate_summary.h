#pragma once
#include <string>

#include "view/report/validation_report.h"

namespace palpate::app {

/// [setup] What was found as one JSON document (docs/validation.md has its fields).
[[nodiscard]] std::string validation_json(const report::Validation& validation);

/// [setup] The same for people: a line a data set, then what was missed.
[[nodiscard]] std::string validation_text(const report::Validation& validation);

}  // namespace palpate::app
