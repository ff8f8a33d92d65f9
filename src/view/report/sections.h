#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/analysis.h"
#include "view/report/gnuplot.h"
#include "view/report/page.h"
#include "view/report/report.h"

namespace palpate::report {

/// [setup] Each function draws one figure with gnuplot to `file` (SVG). When gnuplot is missing or fails,
/// `missing` of the result gives the reason. @throws InputError when `file` cannot be written.
///
/// Depth and force over time; for a moving organ its motion between them.
[[nodiscard]] Figure draw_over_time(const HandAnalysis& hand, const scene::Scene& scene,
                                    const std::filesystem::path& file);
[[nodiscard]] Figure draw_law(const HandAnalysis& hand, const record::Recording& recording,
                              model::Direction direction, const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_spectrum(const HandAnalysis& hand, const scene::Scene& scene,
                                         const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_histogram(const HandAnalysis& hand, const std::filesystem::path& file);

/// The two times of a tick of which histograms are drawn.
enum class TickQuantity { kComputing, kLateness };
[[nodiscard]] Figure draw_tick_histogram(const Analysis& analysis, double rate_Hz, TickQuantity quantity,
                                         const std::filesystem::path& file);

/// The pictures of one experiment.
struct PictureSet {
  std::vector<Figure> overviews;  // before contact, at contact, at depth, after
  std::vector<Figure> close_ups;
  std::string driver;          // OpenGL's name of the renderer
  double moving_p50_ms = 0.0;  // time of a moving picture of the run, balanced, of what changed; wall clock
  double moving_p99_ms = 0.0;
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

/// The figures of one hand.
struct HandFigures {
  Figure over_time;
  Figure law;
  Figure noise_spectrum;
  Figure noise_histogram;
};

/// An experiment with its results, figures and pictures.
struct ExperimentResults {
  const Experiment* experiment = nullptr;
  Analysis analysis;
  PictureSet pictures;
  std::vector<HandFigures> hands;
  Figure tick_time;
  Figure lateness;
};

/// [setup] Title and results, as a table and a list.
void write_summary(Page& page, const std::vector<ExperimentResults>& all);
/// [setup] One experiment in full. @param number counts from 1
void write_experiment(Page& page, const ExperimentResults& worked, std::size_t number);
/// [setup] The results of the paper beside these.
void write_comparison(Page& page, const std::vector<ExperimentResults>& all);
/// [setup] Conditions of the run: scene, organ, tissue parameters, tool, device, noise, limits, machine.
void write_what_was_run(Page& page, const ExperimentResults& worked);

}  // namespace palpate::report
