// `palpate repair`: makes an incomplete recording readable for every HDF5 tool.
#include <filesystem>
#include <iostream>
#include <memory>

#include "io/system/path_text.h"
#include "palpate/recording.h"

#include "app/commands.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

int repair_file(const std::filesystem::path& file) {
  record::RepairResult result;
  {
    Progress bar("repair");
    result =
        record::repair_recording(file, [&](double share) { bar.update(share, "writing " + to_text(file)); });
  }
  std::cout << to_text(file) << ": " << (result.was_damaged ? "repaired, " : "nothing to repair, ")
            << result.rows << " rows\n";
  return kDone;
}

}  // namespace

void add_repair(CLI::App& program, int& exit_code) {
  auto file = std::make_shared<std::filesystem::path>();
  CLI::App* command =
      program.add_subcommand("repair", "Repair an incomplete recording, so that every HDF5 tool can open it");
  command->add_option("recording", *file, "The recording (.h5); it is replaced by the repaired file")
      ->required();
  command->footer("Example:\n  palpate repair run.h5");
  command->callback([file, &exit_code] { exit_code = repair_file(*file); });
}

}  // namespace palpate::app
