#pragma once
#include <filesystem>
#include <string>

#include "fit/identify/needle_fit.h"

namespace palpate::report {

/// [setup] Writes `folder`/report.html (self-contained) and its figures: the tissue's parameters with
/// intervals, and for each record force over depth, measured and of the simulated needle, with the residuals.
/// @return path of report.html. @throws InputError when the folder cannot be written.
std::filesystem::path write_needle_report(const identify::NeedleFit& fit, const std::string& command,
                                          const std::filesystem::path& folder);

}  // namespace palpate::report
