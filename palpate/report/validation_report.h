#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/fit/reach_fit.h"
#include "palpate/fit/rivals.h"
#include "palpate/fit/validation.h"
#include "palpate/report/image_section.h"

namespace palpate::report {

/// A law of others on the same data.
struct RivalResult {
  fit::RivalFit fit;
  double cost_ns = 0.0;  // of one evaluation, processor time
};

/// One measured force curve, ours and the others'.
struct ForceSet {
  fit::ForceComparison ours;
  double cost_ns = 0.0;
  std::vector<RivalResult> rivals;
};

/// One measured profile, ours and the others'.
struct ProfileSet {
  fit::DeformationComparison ours;
  double cost_ns = 0.0;
  std::vector<RivalResult> rivals;
};

/// Everything that `palpate validate` found.
struct Validation {
  fit::Law law;
  std::vector<ForceSet> forces;
  std::vector<ProfileSet> profiles;
  std::optional<fit::ReachFit> reach;  // fitted to the profiles, which then are compared with it
  std::optional<ImageSet> image;       // its comparison is the last of the profiles
  std::vector<std::string> missed;     // goals, in words
};

/// [setup] Writes `folder`/report.html (self-contained) and its figures as files: per data set the measured
/// and the computed curve and their absolute error, as figure 7 of [Zhang 2011], and a table of errors.
/// @param command the command line that made it
/// @return path of report.html. @throws InputError when the folder cannot be written.
std::filesystem::path write_validation_report(const Validation& validation, const std::string& command,
                                              const std::filesystem::path& folder);

}  // namespace palpate::report
