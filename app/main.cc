// The one program: `palpate SUBCOMMAND`. Bad usage and bad input end with exit code 2 and one line in words.
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "palpate/base/text.h"
#include "palpate/fit/crew.h"
#include "palpate/version.h"

#include "app/commands.h"
#include "app/messages.h"

namespace {

/// The words of a command line, quoted where a shell needs it.
std::string joined(int argc, char** argv) {
  std::string line = "palpate";
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

/// What is wrong with a command line, in words.
std::string words_of(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  const std::string help = " (--help shows what there is)";
  const std::string first = argc > 1 ? argv[1] : "";
  std::vector<std::string> known;
  std::string names;
  for (const CLI::App* command : program.get_subcommands({})) {
    known.push_back(command->get_name());
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  const bool is_word = !first.empty() && first.front() != '-';
  if (is_word && std::find(known.begin(), known.end(), first) == known.end()) {
    const std::string near = palpate::nearest_word(first, known);
    return fmt::format("{}: no such command{}{}", first,
                       near.empty() ? "; there are " + names : ", did you mean " + near + "?", help);
  }
  // CLI11: "Could not convert: --seed = abc".
  std::string words = error.what();
  const std::string convert = "Could not convert: ";
  if (words.rfind(convert, 0) != 0) return words + help;
  return words.substr(convert.size()) + ": must be a number" + help;
}

/// Of several that mpirun started, the first speaks for all: they find the same errors.
void tell_once(const std::string& error) {
  if (palpate::fit::launch_of_environment().rank == 0) palpate::app::tell_error(error);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate::app;
  CLI::App program{"Palpate lets a hand feel soft tissue through a force-feedback device, in real time."};
  program.name("palpate");
  program.set_version_flag("--version", std::string("palpate ") + palpate::kVersion);
  program.require_subcommand(1);
  const std::string command_line = joined(argc, argv);
  int exit_code = kDone;
  add_run(program, command_line, exit_code);
  add_demo(program, command_line, exit_code);
  add_model(program, exit_code);
  add_noise(program, exit_code);
  add_inspect(program, exit_code);
  add_replay(program, exit_code);
  add_export(program, exit_code);
  add_repair(program, exit_code);
  add_view(program, exit_code);
  add_serve(program, exit_code);
  add_devices(program, exit_code);
  add_fit(program, command_line, exit_code);
  add_validate(program, command_line, exit_code);
  add_bench(program, command_line, exit_code);
  add_doctor(program, exit_code);
  if (argc == 1) {
    std::cerr << program.help();
    return kBadInput;
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(error);
    tell_once(words_of(program, error, argc, argv));
    return kBadInput;
  } catch (const std::exception& error) {
    tell_once(error.what());
    return kBadInput;
  }
  return exit_code;
}
