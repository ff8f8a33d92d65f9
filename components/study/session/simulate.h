#pragma once
#include <cstdint>
#include <string>

#include "study/session/folder.h"

namespace palpate::study {

/// [setup] All sessions of a participant by formulas, without a run. Times are those of a simulated clock.
/// @param observer as make_person() @return the log, which depends on folder, key, participant and observer
/// alone @throws InputError
[[nodiscard]] std::string simulate_log(const StudyFolder& study, SealedKey key, std::uint32_t participant,
                                       const std::string& observer);

/// [setup] Puts such a log into the folder. @throws InputError when the participant has one
void keep_log(const StudyFolder& study, const std::string& id, const std::string& log);

}  // namespace palpate::study
