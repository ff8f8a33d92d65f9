#pragma once
#include "app/cli.h"

namespace palpate::app {

/// [setup] Adds `palpate ros`, as the functions of app/commands.h.
void add_ros(CLI::App& program, int& exit_code);

}  // namespace palpate::app
