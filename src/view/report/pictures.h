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
  std::string driver;         // OpenGL's name of the renderer
  double draw_ms = 0.0;       // median rendering time of a picture
  int width = 0;              // pixels
  int height = 0;             // pixels
  int contacts_at_depth = 0;  // number of contacts of hand 0 at its deepest tick
  std::string missing;        // reason why there are no pictures; empty: they exist
};

/// [setup] Replays the recording and renders organ and tool before contact, at contact, at the largest depth
/// and at the end, each as overview and close-up. Each kind uses one fixed camera. Writes PNG files into
/// `folder`, with names that begin with `prefix`. Overviews are rendered at double size and averaged. Without
/// OpenGL there are no pictures and `missing` gives the reason. @throws InputError when a file cannot be
/// written.
[[nodiscard]] PictureSet draw_pictures(const record::Recording& recording, const HandAnalysis& hand,
                                       const std::filesystem::path& folder, const std::string& prefix,
                                       const ReportOptions& options);

}  // namespace palpate::report
