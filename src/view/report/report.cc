#include "view/report/report.h"

#include <string>
#include <utility>

#include <fmt/core.h>

#include "view/report/sections.h"

namespace palpate::report {
namespace {

using Progress = std::function<void(double, const std::string&)>;

ExperimentResults work_out(const Experiment& experiment, const std::filesystem::path& folder,
                           std::size_t number, const ReportOptions& options, const Progress& progress) {
  const record::Recording& recording = *experiment.recording;
  const std::string prefix = std::to_string(number) + "-";
  ExperimentResults worked;
  worked.experiment = &experiment;
  worked.analysis = analyse(recording);
  progress(0.1, "pictures of organ and tool");
  worked.pictures =
      draw_pictures(recording, worked.analysis.hands.front(), folder, prefix + "picture-", options);
  progress(0.6, "figures");
  for (const HandAnalysis& hand : worked.analysis.hands) {
    const std::string start =
        prefix + (worked.analysis.hands.size() > 1 ? fmt::format("hand-{}-", hand.hand + 1) : "");
    worked.hands.push_back(
        {draw_over_time(hand, recording.scene, folder / (start + "over-time.svg")),
         draw_law(hand, recording, worked.analysis.direction, folder / (start + "law.svg")),
         draw_noise_spectrum(hand, recording.scene, folder / (start + "noise-spectrum.svg")),
         draw_noise_histogram(hand, folder / (start + "noise-histogram.svg"))});
  }
  const double rate = recording.scene.rate_Hz;
  worked.tick_time = draw_tick_histogram(worked.analysis, rate, TickQuantity::kComputing,
                                         folder / (prefix + "tick-time.svg"));
  worked.lateness =
      draw_tick_histogram(worked.analysis, rate, TickQuantity::kLateness, folder / (prefix + "lateness.svg"));
  return worked;
}

}  // namespace

std::filesystem::path write_report(const std::vector<Experiment>& experiments,
                                   const std::filesystem::path& folder, const Progress& progress,
                                   const ReportOptions& options) {
  make_report_folder(folder);
  const double share = 1.0 / (static_cast<double>(experiments.size()) + 0.1);
  std::vector<ExperimentResults> all;
  for (const Experiment& experiment : experiments) {
    const auto done = static_cast<double>(all.size());
    const Progress part = [&](double fraction, const std::string& what) {
      if (progress) progress(share * (done + fraction), experiment.title + ": " + what);
    };
    all.push_back(work_out(experiment, folder, all.size() + 1, options, part));
  }
  const std::string title = experiments.size() == 1 ? experiments.front().title : "Palpate report";
  const std::string subtitle =
      fmt::format("{}{}, recorded by palpate, an open haptic soft-tissue simulator", experiments.size(),
                  experiments.size() == 1 ? " experiment" : " experiments");
  Page page(title, subtitle);
  write_summary(page, all);
  std::size_t number = 0;
  for (const ExperimentResults& worked : all) write_experiment(page, worked, ++number);
  write_comparison(page, all);
  std::filesystem::path file = page.write(folder);
  if (progress) progress(1.0, "report");
  return file;
}

}  // namespace palpate::report
