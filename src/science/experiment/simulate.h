#pragma once
#include <string>

#include "science/experiment/folder.h"

namespace palpate::experiment {

/// [setup] Fills all sessions of a participant by formulas, without a run. @param observer as make_person()
/// @throws InputError when the log has trials already
void simulate_participant(const StudyFolder& study, SealedKey key, const std::string& id,
                          const std::string& observer);

}  // namespace palpate::experiment
