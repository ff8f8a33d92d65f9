#include "app/streams.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <filesystem>

#include <fcntl.h>
#include <io.h>
// The second header needs the first.
// clang-format off
#include <windows.h>
#include <shellapi.h>
// clang-format on

#include "io/system/path_text.h"

namespace palpate::app {

void prepare_streams() noexcept {
  for (const int descriptor : {0, 1, 2}) (void)_setmode(descriptor, _O_BINARY);
  (void)SetConsoleOutputCP(CP_UTF8);
}

std::vector<std::string> utf8_arguments(int argc, char** argv) {
  int count = 0;
  wchar_t** const words = CommandLineToArgvW(GetCommandLineW(), &count);
  if (words == nullptr) return {argv, argv + argc};
  std::vector<std::string> arguments;
  for (int i = 0; i < count; ++i)
    arguments.push_back(to_text(std::filesystem::path(words[i])));  // UTF-16 to UTF-8
  LocalFree(words);
  return arguments;
}

bool is_terminal(int descriptor) noexcept {
  const HANDLE stream = reinterpret_cast<HANDLE>(_get_osfhandle(descriptor));
  DWORD mode = 0;
  return GetConsoleMode(stream, &mode) != 0 &&
         SetConsoleMode(stream, mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

int write_whole(int descriptor, std::string_view text) noexcept {
  constexpr std::size_t kMost = 1 << 15;  // bytes; older consoles take no more at once
  while (!text.empty()) {
    const int written = _write(descriptor, text.data(), static_cast<unsigned>(std::min(text.size(), kMost)));
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// Windows sends no signal.
IgnoredBrokenPipes::IgnoredBrokenPipes() : before_(nullptr) {}
IgnoredBrokenPipes::~IgnoredBrokenPipes() { (void)before_; }

}  // namespace palpate::app
