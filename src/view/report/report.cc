#include "view/report/report.h"

#include <fmt/core.h>

#include "view/report/sections.h"

namespace palpate::report {
namespace {

using Progress = std::function<void(double, const std::string&)>;

HandFigures draw_hand(const ExperimentResults& worked, std::size_t i, const SurfaceLine& line,
                      const model::FalloffRatios& reach, const std::filesystem::path& start) {
  const HandAnalysis& hand = worked.analysis.hands[i];
  const record::Recording& recording = *worked.experiment->recording;
  const std::optional<ReferenceProfile>& measured = worked.experiment->reference;
  const auto file = [&start](const char* name) { return std::filesystem::path(start.string() + name); };
  return {draw_over_time(hand, recording.scene, file("over-time.svg")),
          went_in(hand) ? draw_needle(hand, recording.scene, file("needle.svg"))
                        : draw_law(hand, recording, worked.analysis.direction, file("law.svg")),
          went_in(hand) ? draw_sections(hand, recording.scene, file("sections.svg"))
                        : draw_profile(line, recording.scene, reach, measured ? &*measured : nullptr,
                                       file("profile.svg")),
          draw_noise_spectrum(hand, recording.scene, file("noise-spectrum.svg")),
          draw_noise_histogram(hand, file("noise-histogram.svg"))};
}

ExperimentResults work_out(const Experiment& experiment, const std::filesystem::path& folder,
                           std::size_t number, const ReportOptions& options, const Progress& progress) {
  const record::Recording& recording = *experiment.recording;
  const std::string prefix = std::to_string(number) + "-";
  ExperimentResults worked;
  worked.experiment = &experiment;
  progress(0.0, "replaying the run");
  worked.analysis = analyse(recording);
  const std::vector<HandAnalysis>& hands = worked.analysis.hands;
  std::vector<std::uint64_t> profile_ticks;
  for (const HandAnalysis& hand : hands) {
    const std::size_t row = row_of_profile(hand, worked.analysis.direction,
                                           experiment.reference ? &*experiment.reference : nullptr);
    profile_ticks.push_back(hand.rows[row].tick);
  }
  const ReplayedMoments moments = replay_moments(recording, hands.front(), profile_ticks);
  progress(0.3, "pictures of organ and tool");
  worked.pictures = draw_pictures(recording, hands.front(), moments, folder, prefix + "picture-", options);
  progress(0.7, "figures");
  const Vec3 across_S = across_pictures_S(recording, hands.front(), moments);
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const std::string start = prefix + (hands.size() > 1 ? fmt::format("hand-{}-", i + 1) : "");
    const SurfaceLine line =
        surface_line(recording.scene, moments.profiles[i], i,
                     experiment.reference ? experiment.reference->across_S.value_or(across_S) : across_S);
    worked.hands.push_back(draw_hand(worked, i, line, moments.profiles[i].reach, folder / start));
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
  Page page(title, lead_sentence(all));
  write_summary(page, all);
  std::size_t number = 0;
  for (const ExperimentResults& worked : all) write_experiment(page, worked, ++number, all.size() > 1);
  write_comparison(page, all);
  write_details(page, all);
  page.paragraph("Recorded and drawn by palpate, an open haptic soft-tissue simulator.");
  std::filesystem::path file = page.write(folder);
  if (progress) progress(1.0, "report");
  return file;
}

}  // namespace palpate::report
