#include <string>

#include <fmt/core.h>
#include <windows.h>

#include "io/record/machine.h"
#include "io/system/path_text.h"

namespace palpate::record {
namespace {

/// A text of the registry, below HKEY_LOCAL_MACHINE; empty when there is none.
std::string registry_text(const wchar_t* key, const wchar_t* name) {
  wchar_t value[256] = {};
  DWORD bytes = sizeof value;
  if (RegGetValueW(HKEY_LOCAL_MACHINE, key, name, RRF_RT_REG_SZ, nullptr, value, &bytes) != ERROR_SUCCESS)
    return {};
  return to_text(std::filesystem::path(value));  // UTF-16 to UTF-8
}

}  // namespace

std::string machine_description() {
  const std::string processor =
      registry_text(L"HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0", L"ProcessorNameString");
  const std::string build =
      registry_text(L"SOFTWARE\\Microsoft\\Windows NT\\CurrentVersion", L"CurrentBuildNumber");
  return fmt::format("{}, Windows build {}{} x86_64", processor.empty() ? "unknown processor" : processor,
                     build.empty() ? "unknown" : build, is_wine() ? " (Wine)" : "");
}

}  // namespace palpate::record
