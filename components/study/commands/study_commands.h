#pragma once
#include <string>

#include "app/cli.h"
#include "study/session/folder.h"

namespace palpate::app {

/// [setup] Text of a preregistration: hypotheses, design, number of people, exclusions and hashes.
[[nodiscard]] std::string preregistration_text(const study::StudyFolder& folder);

/// [setup] Adds `palpate study`, as the functions of app/commands.h.
void add_study(CLI::App& program, const std::string& command_line, int& exit_code);

// Each function adds one subcommand of `palpate study`.
void add_study_check(CLI::App& study, int& exit_code);
void add_study_calibrate(CLI::App& study, int& exit_code);
void add_study_power(CLI::App& study, int& exit_code);
void add_study_prepare(CLI::App& study, int& exit_code);
void add_study_run(CLI::App& study, int& exit_code);
void add_study_simulate(CLI::App& study, int& exit_code);
void add_study_status(CLI::App& study, int& exit_code);
void add_study_verify(CLI::App& study, int& exit_code);
void add_study_analyse(CLI::App& study, const std::string& command_line, int& exit_code);
void add_study_delete(CLI::App& study, int& exit_code);
void add_study_unblind(CLI::App& study, int& exit_code);
void add_study_export(CLI::App& study, int& exit_code);

}  // namespace palpate::app
