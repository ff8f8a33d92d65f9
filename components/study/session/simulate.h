#pragma once
#include <cstdint>
#include <string>

#include "study/session/folder.h"
#include "study/session/simulated_person.h"
#include "study/session/study.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// [setup] All sessions of a participant by formulas, without a run, in memory. Times are those of a
/// simulated clock. An event's after_trials says where it belongs.
[[nodiscard]] ParticipantLog simulate_trials(const Study& study, SealedKey key, std::uint32_t participant,
                                             SimulatedPerson person);

/// [setup] The file of such a log. @param observer as make_person() @return the text, which depends on
/// folder, key, participant and observer alone @throws InputError
[[nodiscard]] std::string simulate_log(const StudyFolder& study, SealedKey key, std::uint32_t participant,
                                       const std::string& observer);

/// [setup] Puts such a log into the folder. @throws InputError when the participant has one
void keep_log(const StudyFolder& study, const std::string& id, const std::string& log);

}  // namespace palpate::study
