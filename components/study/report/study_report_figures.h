#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include "view/report/gnuplot.h"

#include "study/session/analysis.h"

namespace palpate::report {

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

}  // namespace palpate::report
