#pragma once
#include <string>

#include "study/session/analysis.h"

namespace palpate::study {

/// [setup] Two arms of a contrast: "constant - off", or "B against A" while blind.
[[nodiscard]] std::string contrast_name(const StudyAnalysis& analysis, const Contrast& contrast);
/// [setup] Name of a measure: "JND", "threshold", "d'", "RMS error" or "coefficient of variation".
[[nodiscard]] std::string measure_name(const std::string& measure);
/// [any] Whether a measure's effects are logarithms of ratios.
[[nodiscard]] bool is_ratio(const std::string& measure);
/// [setup] A value of an effect: "x 0.85", or "+0.30" of d'.
[[nodiscard]] std::string effect_value(const std::string& measure, double effect);
/// [setup] The 95 % interval of an effect: "0.72 to 1.00".
[[nodiscard]] std::string interval_text(const std::string& measure, const Effect& effect);
/// [setup] An effect with its 95 % interval, its people and its p value.
[[nodiscard]] std::string effect_text(const Contrast& contrast, const Effect& effect);
/// [setup] How many people an effect lacks, by arm after unblinding, with the worst case, and how many
/// thresholds lie outside the stimuli; "" for none of both.
[[nodiscard]] std::string missing_text(const StudyAnalysis& analysis, const Contrast& contrast,
                                       const Effect& effect);
/// [setup] The smallest effect that the study finds with a power of 0.8.
[[nodiscard]] std::string smallest_effect_text(const Contrast& contrast, const Effect& effect);
/// [setup] A person's estimate with its 95 % interval and unit, or the reason for its absence.
[[nodiscard]] std::string estimate_text(const StudyTask& task, const std::optional<ThresholdFit>& fit);
/// [setup] The two one-sided tests of a curve, after unblinding.
[[nodiscard]] std::string inverted_u_text(const Curve& curve);
/// [setup] The effect of StudyAnalysis::own_level.
[[nodiscard]] std::string own_level_text(const Study& study, const Effect& effect);
/// [any] The blocks that guesses are about: "last trial with noise".
[[nodiscard]] const char* blocks_of(const Guesses& guesses);
/// [setup] A p value: "p = 0.021", "p < 0.001".
[[nodiscard]] std::string p_text(double p_value);

/// [setup] Summary for a terminal.
[[nodiscard]] std::string analysis_text(const Study& study, const StudyAnalysis& analysis);
/// [setup] All results as a JSON document.
[[nodiscard]] std::string analysis_json(const Study& study, const StudyAnalysis& analysis);

}  // namespace palpate::study
