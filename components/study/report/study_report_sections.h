#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include "view/report/gnuplot.h"
#include "view/report/page.h"

#include "study/session/analysis.h"
#include "study/session/calibration.h"
#include "study/session/folder.h"

// Sections of the report of a study.
namespace palpate::report {

/// [any] Text as HTML that is not broken between lines.
[[nodiscard]] std::string unbroken(const std::string& text);

/// [setup] A table for each task: every person's estimates, halves, repetition, lapses and bias.
void write_people_tables(Page& page, const study::Study& study, const study::StudyAnalysis& analysis,
                         std::size_t task);
/// [setup] Flags and exclusions.
void write_flags(Page& page, const study::StudyAnalysis& analysis);
/// [setup] The share of the own noise threshold that was reached.
void write_shares(Page& page, const study::Study& study, const study::StudyAnalysis& analysis);
/// [setup] Correlations of answers with force, depth and work.
void write_cues(Page& page, const study::Study& study, const study::StudyAnalysis& analysis);
/// [setup] Guesses about the noise, and who hears it.
void write_blinding(Page& page, const study::StudyAnalysis& analysis);
/// [setup] Spoiled trials, late ticks, times, changes over time.
void write_quality(Page& page, const study::Study& study, const study::StudyAnalysis& analysis);
/// [setup] Limits of the study, and results that would contradict it.
void write_limits(Page& page, const study::Study& study, const study::StudyAnalysis& analysis,
                  bool simulated);

/// [setup] Name of an arm for a reader: "all trials" of a task with one arm without a name.
[[nodiscard]] std::string arm_text(const study::TaskResult& task, std::size_t arm);

/// [setup] Each function draws one figure to `file` (SVG). When gnuplot is missing or fails, `missing` of the
/// result gives the reason. @throws InputError when `file` cannot be written.
///
/// Effects with 95 % intervals, one a line. @param ratios logarithms of ratios, else differences of d'
[[nodiscard]] Figure draw_effects(const study::Study& study, const study::StudyAnalysis& analysis,
                                  bool ratios, const std::filesystem::path& file);
/// Sensitivity at each level of the noise: each person, mean and interval.
[[nodiscard]] Figure draw_curve(const study::Study& study, const study::StudyAnalysis& analysis,
                                const study::Curve& curve, const std::filesystem::path& file);
/// Answers and fitted functions of all people in one task.
[[nodiscard]] Figure draw_people(const study::Study& study, const study::StudyAnalysis& analysis,
                                 std::size_t task, const std::filesystem::path& file);
/// Magnitude and coherence over the frequency, with the band of the gain.
[[nodiscard]] Figure draw_calibration(const study::Calibration& calibration,
                                      const std::filesystem::path& file);

}  // namespace palpate::report
