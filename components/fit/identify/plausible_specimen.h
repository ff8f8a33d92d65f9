#pragma once
#include <string>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] Counts times since 1970 from the specimen's first row, and rejects numbers that are in another
/// unit than their column says, by the table of plausible ranges (io/system/plausible.h). @param where file
/// and specimen, for the message @throws InputError with the unit that would make the numbers usual
void require_plausible(Specimen& specimen, const std::string& where);

}  // namespace palpate::identify
