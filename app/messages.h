#pragma once
#include <string_view>

namespace palpate::app {

/// A line for people on standard error, after the program's name; coloured on a terminal. [setup]
void report_message(std::string_view message);

/// The same for details, which only who set PALPATE_LOG=debug sees.
void report_detail(std::string_view message);

/// The same for what went wrong.
void report_error(std::string_view message);

}  // namespace palpate::app
