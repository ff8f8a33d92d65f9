#include "app/program.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/version.h"
#include "run/devices/crash_stop.h"
#include "run/tasks/communicator.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/session.h"
#include "app/streams.h"

namespace palpate::app {
namespace {

/// [setup] The command line as text that a shell accepts: `program`, then its arguments, quoted where a shell
/// needs quotes.
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

/// [setup] The long flags of a command, with those of its option groups.
std::vector<std::string> flags_of(const CLI::App& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  for (const CLI::App* group : command.get_subcommands({})) {
    if (!group->get_name().empty()) continue;  // a command
    const std::vector<std::string> more = flags_of(*group);
    flags.insert(flags.end(), more.begin(), more.end());
  }
  return flags;
}

/// [setup] One line that describes the first unknown long flag of a command line, and suggests the known one
/// with the most similar name; empty: all are known.
std::string describe_unknown_flag(const CLI::App& program, int argc, char** argv) {
  const CLI::App* command = &program;
  std::string name = program.get_name();
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") break;
    const std::vector<const CLI::App*> commands = command->get_subcommands({});
    const auto next = std::find_if(commands.begin(), commands.end(),
                                   [&word](const CLI::App* one) { return one->get_name() == word; });
    if (next != commands.end()) {
      command = *next;
      name += " " + word;
      continue;
    }
    const std::string flag = word.substr(0, word.find('='));
    if (!flag.starts_with("--")) continue;
    const std::vector<std::string> known = flags_of(*command);
    if (std::find(known.begin(), known.end(), flag) != known.end()) continue;
    const std::string near = nearest_word(flag, known);
    return flag + ": " + name + " has no such flag" + (near.empty() ? "" : ", did you mean " + near + "?") +
           " (see " + name + " --help)";
  }
  return {};
}

constexpr const char* kSeeHelp = " (see --help)";

/// [setup] One line that describes an unknown command, and suggests the known one with the most similar name;
/// empty: it is known, or there is none.
std::string describe_unknown_command(const CLI::App& program, int argc, char** argv) {
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
           (near.empty() ? "; the commands are " + names : ", did you mean " + near + "?") + kSeeHelp;
  }
  return {};
}

/// [setup] One line that describes the error in a command line.
std::string describe(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  if (std::string unknown = describe_unknown_flag(program, argc, argv); !unknown.empty()) return unknown;
  // CLI11 reports a word that is not a number as "Could not convert: --seed = abc".
  std::string message = error.what();
  const std::string convert = "Could not convert: ";
  if (message.rfind(convert, 0) != 0) return message + kSeeHelp;
  return message.substr(convert.size()) + ": must be a number" + kSeeHelp;
}

/// [setup] Rejects an empty word, as from "$FILE" where FILE is not set. An empty name of an output would
/// otherwise mean no output. @throws InputError naming the flag or the position
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

/// Reports an error on MPI rank 0 only, because all ranks that mpirun started find the same error.
void report_once(const std::string& error) {
  if (tasks::launch_of_environment().rank == 0) report_error(error);
}

/// Runs the command of a command line. @return the exit code
int run_command(int argc, char** argv, const AddCommands& add_commands) {
  CLI::App program{"Palpate lets a hand feel soft tissue through a force-feedback device, in real time."};
  program.allow_windows_style_options(false);  // /data/organ.stl is a path
  program.name("palpate");
  program.set_version_flag("--version", std::string("palpate ") + kVersion);
  program.require_subcommand(1);
  int exit_code = kDone;
  const std::string command_line = quoted_command_line("palpate", argc, argv);
  add_commands(program, command_line, exit_code);  // the commands keep references to both
  if (argc == 1) {
    std::cerr << program.help();
    return kBadInput;
  }
  try {
    require_no_empty_word(argc, argv);
    // Before parsing, because CLI11 answers --help after an unknown command with the general help.
    if (const std::string unknown = describe_unknown_command(program, argc, argv); !unknown.empty())
      throw InputError(unknown);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(error);
    report_once(app::describe(program, error, argc, argv));
    return kBadInput;
  } catch (const Cancelled& ended) {
    report_message(ended.what());
    return kDone;
  } catch (const std::exception& error) {
    report_once(error.what());
    return kBadInput;
  } catch (...) {  // of a vendor's library
    report_once("an exception that is none of the standard library's");
    return kBadInput;
  }
  return exit_code;
}

}  // namespace

int run_program(int argc, char** argv, const AddCommands& add_commands) {
  ignore_signals();
  const devices::SignalStack signal_stack;
  ResultStream results;
  const int exit_code = run_command(argc, argv, add_commands);
  const std::string failure = results.failure();
  if (failure.empty()) return exit_code;
  report_error("standard output: " + failure + (exit_code == kDone ? "; everything else is done" : ""));
  return exit_code == kDone ? kBadInput : exit_code;
}

int run_component_program(int argc, char** argv, const AddCommands& add_commands) {
  prepare_streams();
  std::vector<std::string> arguments = utf8_arguments(argc, argv);
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  return run_program(argc, words.data(), add_commands);
}

}  // namespace palpate::app
