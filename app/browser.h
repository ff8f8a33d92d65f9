#pragma once
#include <string>

namespace palpate::app {

/// [setup] Opens an address in the user's browser, if the system has a display and knows one.
/// @return whether it was asked to
bool open_in_browser(const std::string& address);

}  // namespace palpate::app
