// `palpate export`: writes a recording's ticks to a CSV file.
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/core.h>

#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/recording.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/progress.h"
#include "app/session.h"

namespace palpate::app {
namespace {

struct ExportFlags {
  std::filesystem::path file;
  std::filesystem::path csv;
  bool break_blind = false;
};

int export_file(const ExportFlags& flags) {
  const std::filesystem::path changes = record::changes_csv_path(flags.csv);
  const bool has_place_beside = may_have_files_beside(flags.csv);
  require_no_overwrite(std::vector<NamedFile>{{"--csv", flags.csv}, {"beside --csv", changes}},
                       std::vector<NamedFile>{{"the recording", flags.file}});
  require_writable_file(flags.csv, "--csv");
  record::Recording recording;
  {
    Progress bar("export");
    recording = read_to_show(flags.file, "palpate export", flags.break_blind, [&](double share) {
      bar.update(0.3 * share, "reading " + to_text(flags.file));
    });
    record::export_csv(recording, flags.csv,
                       [&](double share) { bar.update(0.3 + 0.7 * share, "writing " + to_text(flags.csv)); });
  }
  if (!recording.changes.empty() && has_place_beside) record::export_changes_csv(recording, changes);
  report_message(fmt::format(
      "{}: {} rows{}", to_text(flags.csv), recording.rows.size(),
      recording.facts.complete ? "" : "; the recording is incomplete: it was cut off after the last row"));
  if (!recording.changes.empty()) {
    report_message(fmt::format(
        "{}: {} changes of tissue or noise during the run",
        has_place_beside ? to_text(changes) : "not written, because no file can be made beside --csv",
        recording.changes.size()));
  }
  return kDone;
}

}  // namespace

void add_export(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command =
      program.add_subcommand("export", "Write a recording's ticks as CSV, one row per tick and hand");
  command->add_option("recording", flags->file, "The recording (.h5)")->required();
  command->add_option("--csv", flags->csv, "The CSV file to write")->required();
  command->add_flag("--break-blind", flags->break_blind, kBreakBlindHelp);
  command->footer("Example:\n  palpate export run.h5 --csv run.csv");
  command->callback([flags, &exit_code] { exit_code = export_file(*flags); });
}

}  // namespace palpate::app
