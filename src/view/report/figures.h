#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/analysis.h"
#include "view/report/gnuplot.h"

namespace palpate::report {

/// [setup] Each function draws one figure with gnuplot to `file` (SVG). When gnuplot is missing or fails,
/// `missing` of the result gives the reason. @throws InputError when `file` cannot be written.
///
/// Depth and force over time; for a moving organ its motion between them.
[[nodiscard]] Figure draw_over_time(const HandAnalysis& hand, const scene::Scene& setup,
                                    const std::filesystem::path& file);
[[nodiscard]] Figure draw_law(const HandAnalysis& hand, const record::Recording& recording,
                              model::Direction direction, const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_spectrum(const HandAnalysis& hand, const scene::Scene& setup,
                                         const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_histogram(const HandAnalysis& hand, const std::filesystem::path& file);

/// The two times of a tick of which histograms are drawn.
enum class TickQuantity { kComputing, kLateness };
[[nodiscard]] Figure draw_tick_histogram(const Analysis& analysis, double rate_Hz, TickQuantity quantity,
                                         const std::filesystem::path& file);

}  // namespace palpate::report
