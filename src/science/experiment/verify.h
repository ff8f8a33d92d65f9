#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "science/experiment/folder.h"

namespace palpate::experiment {

/// Checks a recording. It returns the defect, or an empty text.
using CheckRecording = std::function<std::string(const std::filesystem::path&)>;

/// What was checked.
struct VerifyCounts {
  std::size_t logs = 0;
  std::size_t trials = 0;
  std::size_t recordings = 0;
  std::size_t unfinished = 0;  // recordings of blocks that were cut off; their finished trials count
};

/// [setup] Checks the hash chain of a participant's log, that each trial is the one that follows from the
/// answers before it, and each recording that its events "block" name.
/// @param check_recording empty: recordings must only exist @throws InputError naming the first file, line or
/// recording that is not as it was written
void verify_participant(const StudyFolder& study, SealedKey key, const std::string& id,
                        const CheckRecording& check_recording, VerifyCounts& counts);

}  // namespace palpate::experiment
