#pragma once
#include <string>

#include <CLI/CLI.hpp>

namespace palpate::app {

// Each function adds one subcommand of `palpate study`.

void add_study_run(CLI::App& study, int& exit_code);
void add_study_simulate(CLI::App& study, int& exit_code);

}  // namespace palpate::app
