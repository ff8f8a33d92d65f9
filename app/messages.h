#pragma once
#include <string_view>

namespace palpate::app {

/// A line for people on standard error, after the program's name; coloured on a terminal. [setup]
void tell(std::string_view message);

/// The same for details, which only who set PALPATE_LOG=debug sees.
void tell_detail(std::string_view message);

/// The same for what went wrong.
void tell_error(std::string_view message);

}  // namespace palpate::app
