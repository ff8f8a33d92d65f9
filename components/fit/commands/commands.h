#pragma once
#include <string>

#include "app/cli.h"

namespace palpate::app {

// As the functions of app/commands.h.
void add_fit(CLI::App& program, const std::string& command_line, int& exit_code);
void add_sweep(CLI::App& program, int& exit_code);
void add_validate(CLI::App& program, const std::string& command_line, int& exit_code);

}  // namespace palpate::app
