#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "view/report/page.h"

#include "fit/identify/sweep.h"

namespace palpate::report {

/// [setup] Writes `folder`/report.html (self-contained) and its figures as files: settings of the fit, a
/// figure per specimen (data, fitted curve with its band, residuals), parameters with intervals, warnings, a
/// figure per sweep.
/// @param command the command line of the fit @return path of report.html. @throws InputError when the folder
/// cannot be written.
std::filesystem::path write_fit_report(const std::vector<identify::SpecimenFit>& fits,
                                       const identify::PooledFit& pooled,
                                       const std::vector<identify::Sweep>& sweeps,
                                       const identify::Settings& settings, const std::string& command,
                                       const std::filesystem::path& folder);

}  // namespace palpate::report
