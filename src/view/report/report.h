#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/surface_line.h"

namespace palpate::report {

/// One experiment of a report.
struct Experiment {
  std::string title;  // e.g. "Gallbladder pressed with curved forceps"
  const record::Recording* recording = nullptr;
  std::string command;                          // the command line of the run
  double goal_depth = 0.0;                      // m that the run should reach; 0: none
  std::optional<ReferenceProfile> reference{};  // to show beside the run's deformation
};

/// Settings of the rendered pictures.
struct ReportOptions {
  bool pictures = true;
  int picture_width = 960;   // pixels, of a close-up; an overview is half as wide
  int picture_height = 720;  // pixels
};

/// [setup] Writes `folder`/report.html (self-contained) and its figures as files, and deletes figures of an
/// earlier report there (Page::write).
/// @param progress receives the completed fraction 0..1 and a description of the current step; may be empty
/// @return path of report.html. @throws InputError when the folder cannot be written.
std::filesystem::path write_report(const std::vector<Experiment>& experiments,
                                   const std::filesystem::path& folder,
                                   const std::function<void(double, const std::string&)>& progress,
                                   const ReportOptions& options = {});

}  // namespace palpate::report
