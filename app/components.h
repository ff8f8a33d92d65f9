#pragma once
#include <string_view>

#include "app/cli.h"

namespace palpate::app {

/// [setup] Lists the command `name` of a component among the commands of `program`, without its flags.
/// execute_component() runs it.
void add_component(CLI::App& program, std::string_view name);

/// [setup] The command `name` in the component's own program. @return the command, for its flags
[[nodiscard]] CLI::App* add_component_command(CLI::App& program, std::string_view name);

/// [any] Whether a component has the command `name`.
[[nodiscard]] bool is_of_component(std::string_view name) noexcept;

/// [setup] Replaces this process by the program of a component's command. It looks in the folder of the
/// running program, then in ../libexec/palpate. @param arguments the command and its arguments; ends with a
/// null pointer @return kBadInput, after an error message, when the program cannot be executed
int execute_component(char** arguments);

}  // namespace palpate::app
