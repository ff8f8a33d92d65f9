#pragma once
#include <filesystem>
#include <string>

#include "science/imaging/image_compare.h"
#include "view/report/image_section.h"

namespace palpate::report {

using imaging::Validation;
using validate::ForceSet;
using validate::ProfileSet;
using validate::RivalResult;

/// [setup] Both pairs of zeros of a force curve and what ours leaves with each, indented lines of text.
[[nodiscard]] std::string zeros_text(const ForceSet& set);

/// [setup] Writes `folder`/report.html (self-contained) and its figures as files: per data set the measured
/// and the computed curve and their absolute error, as figure 7 of [Zhang 2011], and a table of errors.
/// @param command the command line that made it
/// @return path of report.html. @throws InputError when the folder cannot be written.
std::filesystem::path write_validation_report(const Validation& validation, const std::string& command,
                                              const std::filesystem::path& folder);

}  // namespace palpate::report
