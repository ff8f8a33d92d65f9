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
#include "view/report/surface_line.h"

namespace palpate::report {

/// [setup] Each function draws one figure with gnuplot to `file` (SVG). When gnuplot is missing or fails,
/// `missing` of the result gives the reason. @throws InputError when `file` cannot be written.
///
/// Depth and force over time; for a moving organ its motion between them.
[[nodiscard]] Figure draw_over_time(const HandAnalysis& hand, const scene::Scene& scene,
                                    const std::filesystem::path& file);
/// Whether a needle was in the tissue.
[[nodiscard]] bool went_in(const HandAnalysis& hand);
/// Force along a needle over the way of its tip, with the punctures.
[[nodiscard]] Figure draw_needle(const HandAnalysis& hand, const scene::Scene& scene,
                                 const std::filesystem::path& file);
/// Sections along a needle with the tissue's layers: before the first puncture, deepest, and on the way out.
[[nodiscard]] Figure draw_sections(const HandAnalysis& hand, const scene::Scene& scene,
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

/// States of a replay that the report draws.
struct ReplayedMoments {
  std::vector<haptics::Snapshot> named;     // before contact, at contact, at depth, after
  std::vector<haptics::Snapshot> moving;    // of the moving pictures that are timed
  std::vector<haptics::Snapshot> profiles;  // of the deformation profiles, one per hand
};

/// [setup] Replays the recording. @param hand that the pictures show @param profile_ticks one per hand
/// @throws InputError as record::snapshots_at()
[[nodiscard]] ReplayedMoments replay_moments(const record::Recording& recording, const HandAnalysis& hand,
                                             const std::vector<std::uint64_t>& profile_ticks);

/// [setup] The direction from left to right in the pictures, in the organ's frame at depth.
[[nodiscard]] Vec3 across_pictures_S(const record::Recording& recording, const HandAnalysis& hand,
                                     const ReplayedMoments& moments);

/// [setup] The deformation along a line as figure 7 of the paper: theory, the run's surface, and a measured
/// profile where there is one; below, absolute errors. @param measured may be null
[[nodiscard]] Figure draw_profile(const SurfaceLine& line, const scene::Scene& scene,
                                  const model::FalloffRatios& reach, const ReferenceProfile* measured,
                                  const std::filesystem::path& file);

/// [setup] Renders organ and tool before contact, at contact, at the largest depth and at the end, each as
/// overview and close-up. Each kind uses one fixed camera. Writes PNG files into
/// `folder`, with names that begin with `prefix`. Overviews are rendered at double size and averaged. Without
/// OpenGL there are no pictures and `missing` gives the reason. @throws InputError when a file cannot be
/// written.
[[nodiscard]] PictureSet draw_pictures(const record::Recording& recording, const HandAnalysis& hand,
                                       const ReplayedMoments& moments, const std::filesystem::path& folder,
                                       const std::string& prefix, const ReportOptions& options);

/// The figures of one hand.
struct HandFigures {
  Figure over_time;
  Figure law;
  Figure profile;
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

/// [setup] The experiments and their main results in one sentence.
[[nodiscard]] std::string lead_sentence(const std::vector<ExperimentResults>& all);
/// [setup] The picture at depth of each experiment, and results that need attention.
void write_summary(Page& page, const std::vector<ExperimentResults>& all);
/// [setup] One experiment: force over depth, deformation, pictures. @param number counts from 1
/// @param several whether the page has more than one experiment
void write_experiment(Page& page, const ExperimentResults& worked, std::size_t number, bool several);
/// [setup] The results of the paper beside these.
void write_comparison(Page& page, const std::vector<ExperimentResults>& all);
/// [setup] Checks, statistics, settings and timing of all experiments, folded.
void write_details(Page& page, const std::vector<ExperimentResults>& all);
/// [setup] Conditions of the run: scene, organ, tissue parameters, tool, device, noise, limits, machine.
void write_what_was_run(Page& page, const ExperimentResults& worked);

/// Results of one experiment in sentences.
enum class Mark { kMet, kLate, kMissed, kInformation };
struct Check {
  Mark mark = Mark::kInformation;
  std::string html;
};
/// [setup] All results of an experiment.
[[nodiscard]] std::vector<Check> checks_of(const ExperimentResults& worked);

/// Largest share of late ticks that needs no more than an explanation (Mark::kLate).
inline constexpr double kUsualLateShare = 1e-3;
/// [setup] Whether ticks were late, and what that means. @param ticks > 0
[[nodiscard]] Check deadline_check(std::uint64_t missed, std::uint64_t ticks);

/// [any] The hand with the largest depth.
[[nodiscard]] const HandAnalysis& main_hand(const ExperimentResults& worked);
/// [any] Whether the recording has tick times; an offline one has them when it was closed properly.
[[nodiscard]] bool is_timed(const Analysis& analysis);
/// [any] Whether the organ is pulled, not pressed.
[[nodiscard]] bool is_pull(const ExperimentResults& worked);
/// [any] A time [ns] in microseconds, with one decimal.
[[nodiscard]] std::string microseconds(std::int64_t ns);

}  // namespace palpate::report
