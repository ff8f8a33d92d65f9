#pragma once
#include <string>

#include "fit/report/validation_report.h"

namespace palpate::app {

/// [setup] The results as one JSON document (docs/validation.md lists its fields).
[[nodiscard]] std::string validation_json(const report::Validation& validation);

/// [setup] The results as a readable summary: the errors of each data set, then the missed goals.
[[nodiscard]] std::string validation_text(const report::Validation& validation);

}  // namespace palpate::app
