#pragma once
#include <functional>
#include <string>

#include "app/cli.h"

namespace palpate::app {

/// Adds the commands of a program. The callback of a command sets `exit_code`. `command_line` is the command
/// as the user typed it; reports show it.
using AddCommands = std::function<void(CLI::App& program, const std::string& command_line, int& exit_code)>;

/// [setup] Runs the program palpate with the command in the arguments, which are UTF-8. Bad usage and bad
/// input end with exit code 2 and one line that describes the error. main() calls it once. @return the exit
/// code
[[nodiscard]] int run_program(int argc, char** argv, const AddCommands& add_commands);

/// [setup] The same for a component's program that replaced it. It prepares the standard streams, too.
/// @param argc, argv of main()
[[nodiscard]] int run_component_program(int argc, char** argv, const AddCommands& add_commands);

}  // namespace palpate::app
