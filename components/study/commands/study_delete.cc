// `palpate study delete`: deletes the data of one person, and keeps a line that says so.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

#include "app/messages.h"
#include "study/commands/study_commands.h"
#include "study/session/deletion.h"
#include "study/session/verify.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct DeleteFlags {
  std::string folder;
  std::string participant;
  std::string why;
  bool yes = false;
};

/// What goes, what stays, and what the program cannot reach.
void print_plan(const study::StudyFolder& study, const std::string& id) {
  const std::vector<fs::path> files = study::files_of_person(study, id);
  std::cout << fmt::format("{} with data of {}:\n", counted(files.size(), "file", "files"), id);
  std::size_t linked = 0;
  for (const fs::path& file : files) {
    std::error_code error;
    linked += fs::hard_link_count(file, error) > 1 && !error ? 1 : 0;
    std::cout << "  " << file.lexically_relative(study.folder).generic_string() << '\n';
  }
  std::cout << fmt::format(
      "participants/{}.jsonl becomes one line with the id, the date and the reason.\n"
      "Nobody else gets number {} of {}, and the orders of the others do not change.\n"
      "The program cannot delete earlier exports (CSV, BIDS), reports, copies and backups, or traces on the "
      "disk.\n",
      id, study.number_of(id) + 1, study.ids.size());
  if (linked > 0) {
    std::cout << fmt::format("{} of the files {} elsewhere, too, as a BIDS export links them.\n", linked,
                             linked == 1 ? "is" : "are");
  }
  for (const std::string& file : study::verify_folder(study)) {
    if (!study::is_leftover(study, file)) {
      std::cout << file << " is not a file of the study: look yourself whether it holds data of " << id
                << ".\n";
    }
  }
}

int delete_data(const DeleteFlags& flags) {
  const study::StudyFolder study = study::open_study(flags.folder);
  const std::string& id = flags.participant;
  static_cast<void>(study.number_of(id));  // refuses an unknown one
  print_plan(study, id);
  if (!flags.yes) {
    std::cout << fmt::format("This cannot be undone. Type {} to delete the data: ", id) << std::flush;
    std::string line;
    std::getline(std::cin, line);
    if (trimmed(line) != id) {
      throw InputError(fmt::format("{}: nothing was deleted; type {}, or give --yes", flags.folder, id));
    }
  }
  const study::Deletion deletion = study::delete_person(study, id, flags.why);
  // On standard error, as of `unblind`: the data are gone, whether or not standard output takes a message.
  report_message(fmt::format("{}: {}", study.study.name, study::deletions_text({{id, deletion}})));
  return kDone;
}

}  // namespace

void add_study_delete(CLI::App& study, int& exit_code) {
  auto flags = std::make_shared<DeleteFlags>();
  CLI::App* command =
      study.add_subcommand("delete", "Delete the data of one person for ever, and keep a note of it");
  command->add_option("folder", flags->folder, "folder made by `palpate study prepare`")->required();
  command->add_option("--participant", flags->participant, "id, as `palpate study status` lists it")
      ->required();
  command->add_option("--why", flags->why, "reason, for the log; no names")->required();
  command->add_flag("--yes", flags->yes, "do not ask");
  command->footer(
      "Examples:\n  palpate study delete touch --participant PX7K2 --why \"asked by letter\"\n"
      "Lists the files first. Every later command says how many people's data were deleted. After a crash "
      "the\n"
      "same command goes on.\n"
      "Exit: 0 deleted (or deleted before), 2 bad input, no data of this person, or not confirmed");
  command->callback([flags, &exit_code] { exit_code = delete_data(*flags); });
}

}  // namespace palpate::app
