#pragma once
#include <string>

#include "view/report/page.h"

#include "study/session/analysis.h"
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

}  // namespace palpate::report
