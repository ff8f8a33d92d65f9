#pragma once
#include <filesystem>
#include <string>

#include "study/session/analysis.h"
#include "study/session/folder.h"

namespace palpate::report {

/// [setup] Writes `folder`/report.html (self-contained) and its figures: effects with intervals, curves, each
/// person's functions, flags, cues, blinding, spoiled trials, limits and registration. Blind, it names no
/// condition. @param command the command line @return path of report.html @throws InputError when the folder
/// cannot be written
std::filesystem::path write_study_report(const study::StudyFolder& study,
                                         const study::StudyAnalysis& analysis,
                                         const std::filesystem::path& folder, const std::string& command);

}  // namespace palpate::report
