#pragma once
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace palpate::app {

/// [setup] The command line as text that a shell accepts: `program`, then its arguments, quoted where a shell
/// needs quotes.
[[nodiscard]] std::string quoted_command_line(std::string program, int argc, char** argv);

/// [setup] One line that describes the error in a command line. For an unknown command it suggests the known
/// command with the most similar name.
[[nodiscard]] std::string describe(const CLI::App& program, const CLI::ParseError& error, int argc,
                                   char** argv);

/// [setup] Rejects an empty word, as from "$FILE" where FILE is not set. An empty name of an output would
/// otherwise mean no output. @throws InputError naming the flag or the position
void require_no_empty_word(int argc, char** argv);

}  // namespace palpate::app
