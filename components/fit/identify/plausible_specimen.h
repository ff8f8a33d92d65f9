#pragma once
#include <string>

#include "io/system/plausible.h"
#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] "must be at most 1000 N": the limit of the possible values that a value [SI] exceeds.
[[nodiscard]] std::string limit_text(const PlausibleRange& range, double value);

/// [setup] Counts times since 1970 from the specimen's first row, and rejects numbers that are in another
/// unit than their column says, by the table of plausible ranges (io/system/plausible.h). @param where file
/// and specimen, for the message @throws InputError with the unit that would make the numbers usual
void require_plausible(Specimen& specimen, const std::string& where);

}  // namespace palpate::identify
