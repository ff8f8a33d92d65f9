#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "view/report/analysis.h"
#include "view/report/gnuplot.h"

namespace palpate::report {

/// [setup] Each draws one figure with gnuplot to `file` (SVG). When gnuplot is missing or fails, the figure
/// says so in `missing`. @throws InputError when `file` cannot be written.
/// Depth and force; where the organ moves, its way between them.
[[nodiscard]] Figure draw_over_time(const HandAnalysis& hand, const scene::Setup& setup,
                                    const std::filesystem::path& file);
[[nodiscard]] Figure draw_law(const HandAnalysis& hand, const record::Recording& recording,
                              model::Direction direction, const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_spectrum(const HandAnalysis& hand, const scene::Setup& setup,
                                         const std::filesystem::path& file);
[[nodiscard]] Figure draw_noise_histogram(const HandAnalysis& hand, const std::filesystem::path& file);

/// Which of a tick's two times a histogram is of.
enum class TickQuantity { kComputing, kLateness };
[[nodiscard]] Figure draw_tick_histogram(const Analysis& analysis, double rate_Hz, TickQuantity quantity,
                                         const std::filesystem::path& file);

}  // namespace palpate::report
