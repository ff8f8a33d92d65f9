#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "palpate/recording.h"

namespace palpate::report {

/// One experiment of a report.
struct Experiment {
  std::string title;  // e.g. "Gallbladder pressed with curved forceps"
  const record::Recording* recording = nullptr;
  std::string command;  // the command line that made it
};

/// How a report's pictures of organ and tool are made.
struct ReportOptions {
  bool pictures = true;
  int picture_width = 960;   // pixels, of a close-up; an overview has half of it
  int picture_height = 720;  // pixels
};

/// [setup] Writes `folder`/report.html (self-contained: pictures inside) and its figures as files.
/// @param progress called with 0..1 and what is being done; may be empty
/// @return path of report.html. @throws InputError when the folder cannot be written.
std::filesystem::path write_report(const std::vector<Experiment>& experiments,
                                   const std::filesystem::path& folder,
                                   const std::function<void(double, const std::string&)>& progress,
                                   const ReportOptions& options = {});

}  // namespace palpate::report
