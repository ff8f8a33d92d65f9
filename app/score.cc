// `palpate score`: scores the search of a recording for hidden inclusions, or its insertions of a needle.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "view/report/palpation_report.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "app/session.h"
#include "app/summary.h"

namespace palpate::app {
namespace {

struct ScoreFlags {
  std::filesystem::path file;
  std::filesystem::path map;
  std::filesystem::path picture;
  std::filesystem::path report;
  bool json = false;
  bool no_cache = false;
  bool break_blind = false;
};

/// @throws InputError for an output that only a search has
int score_insertion(const record::Recording& recording, const ScoreFlags& flags,
                    const std::string& command_line) {
  for (const auto& [flag, file] : {NamedFile{"--map", flags.map}, NamedFile{"--picture", flags.picture}}) {
    if (!file.empty()) throw InputError(std::string(flag) + ": task insert has none: must be left out");
  }
  const palpation::AnyScore score = any_score_of(recording, flags.no_cache);
  if (!flags.report.empty()) {
    report_message("report: " +
                   to_text(report::write_insertion_report(recording, score, flags.report, command_line)));
  }
  if (flags.json) {
    std::cout << palpation::to_json(score) << '\n';
  } else {
    print_score(std::cout, score);
  }
  return kDone;
}

int score_file(const ScoreFlags& flags, const std::string& command_line) {
  const std::filesystem::path& report = flags.report;
  std::vector<NamedFile> outputs{{"--map", flags.map}, {"--picture", flags.picture}};
  if (!flags.report.empty()) {
    require_pictures("--report");
    outputs.push_back({"--report", report / "report.html"});
    outputs.push_back({"--report", report / "felt-stiffness.png"});
    outputs.push_back({"--report", report / "report-figures.sha256"});
    require_writable_folder(report, "--report");
  }
  require_no_overwrite(outputs, std::vector<NamedFile>{{"the recording", flags.file}});
  if (!flags.map.empty()) require_writable_file(flags.map, "--map");
  if (!flags.picture.empty()) require_png_file(flags.picture, "--picture");
  const record::Recording recording = read_to_show(flags.file, "palpate score", flags.break_blind);
  if (recording.rows.empty()) throw InputError(to_text(flags.file) + ": has no tick, must have at least one");
  if (palpation::is_insertion(recording.scene)) return score_insertion(recording, flags, command_line);
  palpation::require_search(recording.scene, to_text(flags.file),
                            "palpate run --task palpate makes a search");
  const palpation::ScoredRecording scored = score_of(recording, flags.no_cache);
  const palpation::Scorer& made = scored.scorer();
  if (!flags.map.empty()) palpation::write_map(made.map(), flags.map);
  if (!flags.picture.empty()) write_png(report::draw_felt_stiffness(recording.scene, made), flags.picture);
  if (!flags.report.empty()) {
    report_message("report: " +
                   to_text(report::write_palpation_report(recording.scene, made, report, command_line)));
  }
  if (flags.json) {
    std::cout << palpation::to_json(made.score()) << '\n';
  } else {
    print_score(std::cout, made.score());
  }
  return kDone;
}

}  // namespace

void add_score(CLI::App& program, const std::string& command_line, int& exit_code) {
  auto flags = std::make_shared<ScoreFlags>();
  CLI::App* command = program.add_subcommand(
      "score", "Score a search for hidden lumps (and map the felt stiffness), or the insertions of a needle");
  command->add_option("recording", flags->file, "The recording (.h5)")->required();
  command->add_option("--map", flags->map,
                      "write the felt and the true stiffness over the organ's surface to this CSV file");
  command->add_option("--picture", flags->picture,
                      "draw both over the organ, with lumps and marks, as a PNG");
  command->add_option("--report", flags->report,
                      "write report.html with score, figures and definitions to this folder");
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  command->add_flag("--break-blind", flags->break_blind, kBreakBlindHelp);
  command->add_flag("--json", flags->json, "print one JSON document");
  command->footer(
      "Examples:\n  palpate run --task palpate --device mouse --record search.h5\n"
      "  palpate score search.h5 --map felt.csv --picture felt.png --report out\n"
      "  palpate run examples/epidural.toml --offline --record epidural.h5\n  palpate score epidural.h5\n"
      "A hand marks a place by a button, M in the window. docs/lumps.md and docs/needle.md define every "
      "number.");
  command->callback([flags, &command_line, &exit_code] { exit_code = score_file(*flags, command_line); });
}

}  // namespace palpate::app
