#pragma once
// What the program writes to its standard streams. A hand may be held while it writes, so a reader that does
// not read must not make the program wait.
#include <streambuf>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "app/streams.h"

namespace palpate::app {

/// [any] The text with its control characters, also those of bidirectional text, and its bytes that are no
/// UTF-8 as "\x1B", because foreign names and messages could contain commands for the terminal. @param lines
/// keeps line ends and tabs
[[nodiscard]] std::string escaped(std::string_view text, bool lines);

/// [setup] A JSON document as text, indented by `indent` (-1: one line). Bytes of names that are no UTF-8 are
/// replaced.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

/// [setup] Writes text to standard output or standard error (STDOUT_FILENO, STDERR_FILENO). Waits for the
/// reader, except during the lifetime of a BackgroundOutput. Errors of standard output are reported by
/// ResultStream::failure().
void write_text(int descriptor, std::string text);

/// During its lifetime write_text() does not wait: each stream has a thread that writes its texts in order.
/// Texts that do not fit into kRoom are dropped; when the reader reads again, a message states how many lines
/// were lost. A reader that closes its end does not end the program. One object at a time.
class BackgroundOutput final {
 public:
  static constexpr std::size_t kRoom = std::size_t{1} << 18U;  // bytes that wait for a reader, per stream

  /// [setup]
  BackgroundOutput();
  /// [setup] Waits until everything is written, but at most one second.
  ~BackgroundOutput();
  BackgroundOutput(const BackgroundOutput&) = delete;
  BackgroundOutput& operator=(const BackgroundOutput&) = delete;

 private:
  IgnoredBrokenPipes pipes_;
};

/// During its lifetime std::cout, by which commands print their results, writes by write_text() and escapes
/// control characters. One object at a time.
class ResultStream final : private std::streambuf {
 public:
  /// [setup]
  ResultStream();
  ~ResultStream() override;
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;

  /// [setup] Writes what is buffered. @return why results are missing from standard output; empty: none are
  [[nodiscard]] std::string failure();

 private:
  int_type overflow(int_type letter) override;
  std::streamsize xsputn(const char* letters, std::streamsize count) override;
  int sync() override;
  bool write(std::size_t count);

  std::streambuf* before_;
  std::string text_;
};

}  // namespace palpate::app
