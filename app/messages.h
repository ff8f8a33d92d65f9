#pragma once
#include <string_view>

namespace palpate::app {

/// [setup] Prints one line on standard error after the program's name; coloured on a terminal.
void report_message(std::string_view message);

/// [setup] Prints a detail on standard error, only with PALPATE_LOG=debug in the environment.
void report_detail(std::string_view message);

/// [setup] Prints an error on standard error.
void report_error(std::string_view message);

}  // namespace palpate::app
