#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/analysis.h"
#include "view/report/figures.h"
#include "view/report/report.h"

namespace palpate::report {

/// The pictures of one experiment.
struct PictureSet {
  std::vector<Figure> overviews;  // before contact, at contact, at depth, after
  std::vector<Figure> close_ups;
  std::string driver;         // OpenGL's name of what drew them
  double draw_ms = 0.0;       // median time of one picture
  int width = 0;              // pixels
  int height = 0;             // pixels
  int contacts_at_depth = 0;  // of hand 0, at its deepest tick
  std::string missing;        // why there are none, in words; empty: they are there
};

/// [setup] Runs the recording again and draws organ and tool at rest, at contact, at depth and at the end,
/// each as overview and close-up, all from the same two places, into PNG files in `folder` that begin with
/// `prefix`. Overviews are halved, which smooths them. Without OpenGL there is no picture and `missing` says
/// why. @throws InputError when a file cannot be written.
[[nodiscard]] PictureSet draw_pictures(const record::Recording& recording, const HandAnalysis& hand,
                                       const std::filesystem::path& folder, const std::string& prefix,
                                       const ReportOptions& options);

}  // namespace palpate::report
