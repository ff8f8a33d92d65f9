#include <string>

#include <windows.h>

#include "io/system/plugin.h"

namespace palpate {

std::filesystem::path folder_of_program() {
  constexpr std::size_t kLongestPath = 32'768;  // UTF-16 units
  std::wstring program(kLongestPath, L'\0');
  const DWORD length = GetModuleFileNameW(nullptr, program.data(), static_cast<DWORD>(program.size()));
  if (length == 0 || length == program.size()) return {};
  program.resize(length);
  return std::filesystem::path(program).parent_path();
}

}  // namespace palpate
