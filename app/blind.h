#pragma once
#include <filesystem>

#include "palpate/recording.h"

namespace palpate::app {

/// Help text of --break-blind.
inline constexpr const char* kBreakBlindHelp =
    "open a recording of a study that is still blind; blind-broken.jsonl beside it keeps a note";

/// [setup] Reads a recording for a command that shows its forces. @param break_blind the flag --break-blind
/// was given @throws InputError as record::read_recording() and record::break_blind()
[[nodiscard]] inline record::Recording read_to_show(const std::filesystem::path& file, const char* command,
                                                    bool break_blind, const record::Progress& progress = {}) {
  return break_blind ? record::break_blind(file, command, progress) : record::read_recording(file, progress);
}

}  // namespace palpate::app
