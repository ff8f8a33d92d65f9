#include "app/execute.h"

#include <cerrno>
#include <cstdlib>
#include <string>

#include <windows.h>

#include "io/system/path_text.h"

namespace palpate::app {
namespace {

/// A word of a command line as CommandLineToArgvW() reads it.
std::wstring quoted(const std::wstring& word) {
  std::wstring text = L"\"";
  std::size_t slashes = 0;
  for (const wchar_t letter : word) {
    if (letter == L'"') text.append(slashes + 1, L'\\');
    slashes = letter == L'\\' ? slashes + 1 : 0;
    text += letter;
  }
  return text.append(slashes, L'\\') + L"\"";
}

}  // namespace

int execute(const std::filesystem::path& program, char** arguments) {
  std::filesystem::path file = program;
  file += ".exe";
  std::wstring line = quoted(file.wstring());
  for (; *arguments != nullptr; ++arguments) line += L" " + quoted(to_path(*arguments).wstring());
  STARTUPINFOW start{};
  start.cb = sizeof start;
  PROCESS_INFORMATION child{};
  if (CreateProcessW(file.c_str(), line.data(), nullptr, nullptr, TRUE, 0, nullptr, nullptr, &start,
                     &child) == 0) {
    const DWORD error = GetLastError();
    return error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND ? ENOENT : EACCES;
  }
  (void)SetConsoleCtrlHandler(nullptr, TRUE);  // Ctrl-C is for the child, which ends in its own way
  DWORD code = 1;
  (void)WaitForSingleObject(child.hProcess, INFINITE);
  (void)GetExitCodeProcess(child.hProcess, &code);
  std::exit(static_cast<int>(code));
}

}  // namespace palpate::app
