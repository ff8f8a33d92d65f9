#include "app/command_line.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::app {

std::string quoted_command_line(std::string program, int argc, char** argv) {
  std::string line = std::move(program);
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\$`*?[]{}()<>|&;~#!") == std::string_view::npos;
    line += ' ';
    if (plain) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char letter : word) line += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    line += '\'';
  }
  return line;
}

std::string describe(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  const std::string help = " (see --help)";
  const std::string first = argc > 1 ? argv[1] : "";
  std::vector<std::string> known;
  std::string names;
  for (const CLI::App* command : program.get_subcommands({})) {
    known.push_back(command->get_name());
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  const bool is_word = !first.empty() && first.front() != '-';
  if (is_word && !known.empty() && std::find(known.begin(), known.end(), first) == known.end()) {
    const std::string near = nearest_word(first, known);
    return first + ": no such command" +
           (near.empty() ? "; the commands are " + names : ", did you mean " + near + "?") + help;
  }
  // CLI11 reports a word that is not a number as "Could not convert: --seed = abc".
  std::string words = error.what();
  const std::string convert = "Could not convert: ";
  if (words.rfind(convert, 0) != 0) return words + help;
  return words.substr(convert.size()) + ": must be a number" + help;
}

void require_no_empty_word(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool is_flag = word.rfind("--", 0) == 0;
    if (is_flag && word.back() == '=') {
      throw InputError(std::string(word.substr(0, word.size() - 1)) + ": is empty, must have a value");
    }
    if (!word.empty()) continue;
    const std::string before = argv[i - 1];
    throw InputError((i > 1 && before.rfind('-', 0) == 0 ? before : "argument " + std::to_string(i)) +
                     ": is empty, must have a value");
  }
}

}  // namespace palpate::app
