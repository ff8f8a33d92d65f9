#include "app/browser.h"

#include <cstdint>

// The second header needs the first.
// clang-format off
#include <windows.h>
#include <shellapi.h>
// clang-format on

#include "io/system/path_text.h"

namespace palpate::app {

bool open_in_browser(const std::string& address) {
  constexpr std::intptr_t kLastError = 32;  // ShellExecuteW() returns more when it succeeds
  const std::wstring text = to_path(address).wstring();
  return reinterpret_cast<std::intptr_t>(
             ShellExecuteW(nullptr, L"open", text.c_str(), nullptr, nullptr, SW_SHOWNORMAL)) > kLastError;
}

}  // namespace palpate::app
