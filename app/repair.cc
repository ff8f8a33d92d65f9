// `palpate repair`: makes an incomplete recording readable for every HDF5 tool.
#include <iostream>
#include <memory>
#include <string>

#include "palpate/recording.h"

#include "app/commands.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

int repair_file(const std::string& file) {
  record::RepairResult result;
  {
    Progress bar("repair");
    result = record::repair_recording(file, [&](double share) { bar.update(share, "writing " + file); });
  }
  std::cout << file << ": " << (result.was_damaged ? "repaired, " : "nothing to repair, ") << result.rows
            << " rows\n";
  return kDone;
}

}  // namespace

void add_repair(CLI::App& program, int& exit_code) {
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      program.add_subcommand("repair", "Repair an incomplete recording, so that every HDF5 tool can open it");
  command->add_option("recording", *file, "The recording (.h5); it is replaced by the repaired file")
      ->required();
  command->footer("Example:\n  palpate repair run.h5");
  command->callback([file, &exit_code] { exit_code = repair_file(*file); });
}

}  // namespace palpate::app
