#include "app/browser.h"

#include <cstdlib>
#include <system_error>

#include "io/system/child_process.h"

namespace palpate::app {

bool open_in_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return false;
  ChildProcess browser;
  browser.arguments = {"xdg-open", address};
  browser.messages = "/dev/null";
  browser.apart = true;
  std::error_code error;
  (void)start_process(browser, error);
  return !error;
}

}  // namespace palpate::app
