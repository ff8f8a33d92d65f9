#pragma once
#include <span>
#include <string>

#include "palpate/recording.h"

#include "study/session/course.h"

namespace palpate::study {

/// A trial of a log beside the trial that the course planned.
struct ReplayedTrial {
  Trial planned;
  TrialRecord logged;
};

/// [setup] Compares the trials of a block with its recording. Each interval of the log, and no other one
/// before the last trial's end, must be in the recording at its tick. For each trial that is not spoiled, the
/// recorded noise, commanded force, stiffness and stiffness ratio of the inclusion must be those that the
/// trial planned, and peak, mean, depth and work must follow from the rows, bit for bit.
/// @return the first defect; empty: none
[[nodiscard]] std::string compare_with_recording(const Study& study, std::span<const ReplayedTrial> trials,
                                                 const record::Recording& recording);

}  // namespace palpate::study
