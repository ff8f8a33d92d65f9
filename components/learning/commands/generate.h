#pragma once
#include <CLI/CLI.hpp>

namespace palpate::app {

/// [setup] Adds `palpate generate`, as the functions of app/commands.h.
void add_generate(CLI::App& program, int& exit_code);

}  // namespace palpate::app
