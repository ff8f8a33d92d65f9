#pragma once
#include <vector>

#include "view/report/analysis.h"
#include "view/report/figures.h"
#include "view/report/page.h"
#include "view/report/pictures.h"
#include "view/report/report.h"

namespace palpate::report {

/// The figures of one hand.
struct HandFigures {
  Figure over_time;
  Figure law;
  Figure noise_spectrum;
  Figure noise_histogram;
};

/// One experiment with all that the page shows of it.
struct WorkedExperiment {
  const Experiment* experiment = nullptr;
  Analysis analysis;
  PictureSet pictures;
  std::vector<HandFigures> hands;
  Figure tick_time;
  Figure lateness;
};

/// [setup] Title and what came out, in one table and in words.
void write_summary(Page& page, const std::vector<WorkedExperiment>& all);
/// [setup] One experiment in full. @param number from 1
void write_experiment(Page& page, const WorkedExperiment& worked, std::size_t number);
/// [setup] The paper's own figures beside ours.
void write_comparison(Page& page, const std::vector<WorkedExperiment>& all);
/// [setup] Everything that was run: scene, organ, tissue with all parameters, tool, device, noise, limits,
/// machine.
void write_what_was_run(Page& page, const WorkedExperiment& worked);

}  // namespace palpate::report
