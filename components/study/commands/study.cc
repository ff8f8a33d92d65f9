// `palpate study`: experiments on people and simulated observers.
#include "app/components.h"
#include "study/commands/study_commands.h"

namespace palpate::app {

void add_study(CLI::App& program, const std::string& command_line, int& exit_code) {
  CLI::App* study = add_component_command(program, "study");
  study->require_subcommand(1);
  add_study_check(*study, exit_code);
  add_study_calibrate(*study, exit_code);
  add_study_power(*study, exit_code);
  add_study_prepare(*study, exit_code);
  add_study_run(*study, exit_code);
  add_study_simulate(*study, exit_code);
  add_study_status(*study, exit_code);
  add_study_verify(*study, exit_code);
  add_study_analyse(*study, command_line, exit_code);
  add_study_delete(*study, exit_code);
  add_study_unblind(*study, exit_code);
  add_study_export(*study, exit_code);
}

}  // namespace palpate::app
