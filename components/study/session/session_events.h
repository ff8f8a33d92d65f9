#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/session/course.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// [setup] An event of this moment.
[[nodiscard]] EventRecord event_of(const std::string& name,
                                   std::vector<std::pair<std::string, std::string>> values);

/// [setup] How the practice with a criterion ended. @param last the trial that was added last; empty: it did
/// not end a practice
[[nodiscard]] std::optional<EventRecord> practice_event(const Study& study, const Course& course,
                                                        const TrialRecord& last);

/// [setup] The noise threshold [N] that the session's noise follows from, with its 95 % interval, the session
/// in which it was measured, and whether it lies at the edge of the stimuli: "no", "least" or "largest".
/// @param decision what is done with one at the edge; empty: nothing
[[nodiscard]] EventRecord threshold_event(int session, const Course::Threshold& threshold,
                                          const std::string& decision);

}  // namespace palpate::study
