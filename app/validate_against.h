#pragma once
#include <vector>

#include "palpate/report/validation_report.h"

namespace palpate::app {

/// [setup] Fits the laws of others to every data set of `validation` and measures what one evaluation of
/// each, and of ours, costs in processor time.
void compare_with(const std::vector<fit::RivalKind>& kinds, const fit::Zeros& zeros,
                  report::Validation& validation);

}  // namespace palpate::app
