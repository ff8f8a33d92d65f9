#pragma once
#include "app/cli.h"

namespace palpate::app {

/// [setup] Adds --jobs to a command with many tasks: the most threads that this process uses for them.
/// Default: all processors. Results are the same for any number.
void add_jobs(CLI::App& command);

}  // namespace palpate::app
