#pragma once
#include <filesystem>
#include <string>

#include "view/report/page.h"

#include "fit/imaging/image_compare.h"

namespace palpate::report {

using imaging::ImageSet;

/// [setup] One line that describes the confidence of an image measurement.
[[nodiscard]] std::string image_text(const ImageSet& set);

using imaging::Validation;
using validate::BaselineResult;
using validate::ForceSet;
using validate::ProfileSet;

/// [setup] Given and fitted zeros of a force curve with the errors of the law for each, as indented lines.
[[nodiscard]] std::string zeros_text(const ForceSet& set);

/// [setup] Writes `folder`/report.html (self-contained) and its figures as files: for each data set the
/// measured and computed curve and their absolute error, as in figure 7 of [Zhang 2011], and a table of
/// errors.
/// @param command the command line of the validation @return path of report.html.
/// @throws InputError when the folder cannot be written.
std::filesystem::path write_validation_report(const Validation& validation, const std::string& command,
                                              const std::filesystem::path& folder);

}  // namespace palpate::report
