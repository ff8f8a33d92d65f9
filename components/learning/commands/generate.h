#pragma once
#include "app/cli.h"

namespace palpate::app {

/// [setup] Adds `palpate generate`, as the functions of app/commands.h.
void add_generate(CLI::App& program, int& exit_code);

}  // namespace palpate::app
