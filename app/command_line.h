#pragma once
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace palpate::app {

/// [setup] `program` and its arguments as a shell takes them: an argument is quoted where it needs quotes.
[[nodiscard]] std::string quoted_command_line(std::string program, int argc, char** argv);

/// [setup] One line that says what is wrong with a command line: the nearest command for an unknown one.
[[nodiscard]] std::string describe(const CLI::App& program, const CLI::ParseError& error, int argc,
                                   char** argv);

}  // namespace palpate::app
