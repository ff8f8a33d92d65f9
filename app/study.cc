// `palpate study`: experiments on people and simulated observers.
#include "app/study_commands.h"

#include "app/commands.h"

namespace palpate::app {

void add_study(CLI::App& program, const std::string& /*command_line*/, int& /*exit_code*/) {
  CLI::App* study = program.add_subcommand(
      "study", "Plan, run and analyse an experiment: does the touch noise help people?");
  study->require_subcommand(1);
}

}  // namespace palpate::app
