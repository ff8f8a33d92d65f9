// `palpate study analyse`, `unblind` and `export`.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/output_file.h"
#include "palpate/error.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/session.h"
#include "study/commands/study_commands.h"
#include "study/report/study_report.h"
#include "study/session/analysis.h"
#include "study/session/analysis_text.h"
#include "study/session/bids.h"
#include "study/session/block_scene.h"
#include "study/session/deletion.h"
#include "study/session/folder.h"
#include "study/session/trial_table.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;
using study::Participant;
using study::StudyFolder;

struct AnalyseFlags {
  std::string folder;
  std::string report;
  std::string why;
  bool early = false;
  std::string csv;
  std::string bids;
  std::string preregistration;
  bool as_json = false;
};

/// @throws InputError when the file or folder exists
void require_absent(const fs::path& path, const std::string& flag) {
  if (file_exists(path)) {
    throw InputError(flag + " " + path.string() + ": exists and is not overwritten; give another name");
  }
}

int analyse(const AnalyseFlags& flags, const std::string& command_line) {
  const fs::path report = flags.report;
  if (!flags.report.empty()) {
    require_absent(report / "report.html", "--report");
    require_writable_folder(report, "--report");
  }
  const StudyFolder study = study::open_study(flags.folder);
  const std::vector<Participant> people = study::read_people(study);
  const study::StudyAnalysis analysis = study::analyse(study.study, people, study.key, study.unblinded());
  if (analysis.people.empty()) {
    throw InputError(flags.folder +
                     ": no participant has a trial yet; `palpate study run` or `simulate` first");
  }
  if (!flags.report.empty()) {
    report_message("report: " + report::write_study_report(study, analysis, report, command_line).string());
  }
  std::cout << (flags.as_json ? study::analysis_json(study.study, analysis)
                              : study::analysis_text(study.study, analysis));
  return kDone;
}

int unblind(const AnalyseFlags& flags) {
  StudyFolder study = study::open_study(flags.folder);
  const std::vector<std::string> unfinished = study::unfinished_people(study);
  study::unblind_study(study, flags.why, flags.early);
  // On standard error: the study is unblinded, whether or not standard output takes a message.
  report_message(study.study.name +
                 ": unblinded once and for ever; unblinded.json has the time and the reason");
  if (unfinished.empty()) return kDone;
  report_message(fmt::format("ended early: {} cannot be run any more: {}",
                             counted(unfinished.size(), "participant", "participants"), joined(unfinished)));
  return kDone;
}

int export_trials(const AnalyseFlags& flags) {
  const int outputs =
      (flags.csv.empty() ? 0 : 1) + (flags.bids.empty() ? 0 : 1) + (flags.preregistration.empty() ? 0 : 1);
  if (outputs != 1) throw InputError("give one of --csv FILE, --bids FOLDER and --preregistration FILE");
  const StudyFolder study = study::open_study(flags.folder);
  if (!flags.preregistration.empty()) {
    require_absent(flags.preregistration, "--preregistration");
    write_output(flags.preregistration, preregistration_text(study), "--preregistration");
    report_message("preregistration: " + flags.preregistration);
    return kDone;
  }
  std::vector<Participant> people = study::read_people(study);
  const double rate_Hz = study::study_scene(study.study, "").rate_Hz;
  for (Participant& person : people) {
    if (!person.log.withdrawn())
      person.renderings = study::renderings_of(study.study, study.key, person, rate_Hz);
  }
  const study::ArmNames names(study.study, study.key, study.unblinded());
  const std::string deleted = study::deletions_text(study::deletions_of(people));
  if (!flags.csv.empty()) {
    require_absent(flags.csv, "--csv");
    write_output(flags.csv, study::table_csv(study.study, people, names), "--csv");
    report_message("trials: " + flags.csv + (deleted.empty() ? "" : "; " + deleted));
    return kDone;
  }
  study::write_bids(
      {study.study, people, names, study.folder / "recordings", study.lock_hash, study.simulated},
      flags.bids);
  report_message("BIDS: " + flags.bids + (deleted.empty() ? "" : "; " + deleted));
  return kDone;
}

}  // namespace

void add_study_analyse(CLI::App& study, const std::string& command_line, int& exit_code) {
  auto flags = std::make_shared<AnalyseFlags>();
  CLI::App* command = study.add_subcommand(
      "analyse", "Thresholds, effects, curves and flags; blind until the study is unblinded");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--report", flags->report, "folder for report.html and its figures");
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n"
      "  palpate study analyse touch\n"
      "  palpate study analyse touch --report out\n"
      "Blind, conditions are A, B, C, and the primary contrast and the inverted U are not shown.\n"
      "People who withdrew are left out.\n"
      "Exit: 0 done, 2 bad input, a changed log or no trials");
  command->callback([flags, &command_line, &exit_code] { exit_code = analyse(*flags, command_line); });
}

void add_study_unblind(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<AnalyseFlags>();
  CLI::App* command =
      study.add_subcommand("unblind", "Show the conditions from now on; it is logged and cannot be undone");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--why", flags->why, "reason, for the log")->required();
  command->add_flag("--early", flags->early,
                    "also while participants are not finished, who are then not run");
  command->footer(
      "Examples:\n"
      "  palpate study analyse touch\n"
      "  palpate study unblind touch --why \"all 24 sessions done, blind analysis archived\"\n"
      "Exit: 0 done, 2 bad input, unblinded before, or participants are not finished (without --early)");
  command->callback([flags, &exit_code] { exit_code = unblind(*flags); });
}

void add_study_export(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<AnalyseFlags>();
  CLI::App* command = study.add_subcommand("export", "All trials as one CSV file, or as a BIDS folder");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--csv", flags->csv, "new CSV file, one row a trial");
  command->add_option("--preregistration", flags->preregistration,
                      "new text file for a registry: hypotheses, exclusions, number of people, hashes");
  command->add_option("--bids", flags->bids, "new or empty folder for the Brain Imaging Data Structure");
  command->footer(
      "Examples:\n"
      "  palpate study export touch --csv trials.csv\n"
      "  palpate study export touch --bids touch-bids\n"
      "  palpate study export touch --preregistration registration.md\n"
      "Until unblinding, the CSV file has each person's own codes and the BIDS folder no conditions.\n"
      "Exit: 0 done, 2 bad input or an output that exists");
  command->callback([flags, &exit_code] { exit_code = export_trials(*flags); });
}

}  // namespace palpate::app
