#pragma once
// The program's standard streams and arguments, in each system's way (posix/, windows/).
#include <string>
#include <string_view>
#include <vector>

namespace palpate::app {

/// [setup] Prepares the standard streams for UTF-8 and for results byte by byte. main() calls it once.
void prepare_streams() noexcept;

/// [setup] The program's arguments, its name first, in UTF-8. @param argc, argv of main()
[[nodiscard]] std::vector<std::string> utf8_arguments(int argc, char** argv);

/// [setup] Whether a stream (STDOUT_FILENO, STDERR_FILENO) is a terminal that obeys escape sequences.
[[nodiscard]] bool is_terminal(int descriptor) noexcept;

/// [any] Writes a whole text and waits for its reader. @return 0, or the errno of the failure
int write_whole(int descriptor, std::string_view text) noexcept;

/// During its lifetime a reader that closes its end of a pipe does not end the program.
class IgnoredBrokenPipes final {
 public:
  /// [setup]
  IgnoredBrokenPipes();
  ~IgnoredBrokenPipes();
  IgnoredBrokenPipes(const IgnoredBrokenPipes&) = delete;
  IgnoredBrokenPipes& operator=(const IgnoredBrokenPipes&) = delete;

 private:
  void (*before_)(int);
};

}  // namespace palpate::app
