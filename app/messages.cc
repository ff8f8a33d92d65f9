#include "app/messages.h"

#include <cstdlib>
#include <string>

#include <unistd.h>

#include "app/output.h"

namespace palpate::app {
namespace {

/// A variable of the environment; empty when it is not set.
std::string_view environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing writes it
  return value == nullptr ? std::string_view() : std::string_view(value);
}

/// @param colour escape sequence of a terminal
void report(std::string_view colour, std::string_view message) {
  static const bool coloured =
      is_terminal(STDERR_FILENO) && !environment("TERM").empty() && environment("TERM") != "dumb";
  std::string line = "palpate: ";
  if (coloured) line += colour;
  line += escaped(message, false);
  if (coloured) line += "\033[m";
  write_text(STDERR_FILENO, line + '\n');
}

}  // namespace

void report_message(std::string_view message) { report("\033[32m", message); }

void report_detail(std::string_view message) {
  static const bool wanted = environment("PALPATE_LOG") == "debug";
  if (wanted) report("\033[36m", message);
}

void report_error(std::string_view message) { report("\033[31m\033[1m", message); }

}  // namespace palpate::app
