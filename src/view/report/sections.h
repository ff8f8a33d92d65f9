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
