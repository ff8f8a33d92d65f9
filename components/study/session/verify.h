#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "palpate/recording.h"

#include "study/session/folder.h"

namespace palpate::study {

/// Checks a recording. It returns the defect, or an empty text.
using CheckRecording = std::function<std::string(const record::Recording&)>;

/// What was checked.
struct VerifyCounts {
  std::size_t logs = 0;
  std::size_t trials = 0;
  std::size_t recordings = 0;
  Deletions deleted;
  std::size_t unfinished = 0;  // recordings of blocks that were cut off; their finished trials count
};

/// [setup] Checks that heads.txt ends after the last participant's line. @return the files in the folder that
/// are no part of the study, by their path in it @throws InputError
[[nodiscard]] std::vector<std::string> verify_folder(const StudyFolder& study);

/// [setup] Checks that a participant's log is consistent with the sealed key (each line's mac, the chain, the
/// log's head) and that each trial follows from the answers before it. Each recording that an event "block"
/// names must have the SHA-256 of that event, be of this study, and pass compare_with_recording(). Of a
/// person whose data were deleted nothing may be left.
/// @param check_recording empty: recordings must only exist @throws InputError naming the first file, line or
/// recording that is inconsistent
void verify_participant(const StudyFolder& study, const std::string& id,
                        const CheckRecording& check_recording, VerifyCounts& counts);

}  // namespace palpate::study
