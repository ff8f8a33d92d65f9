#include "app/program.h"

#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include "palpate/version.h"
#include "run/devices/crash_stop.h"
#include "run/tasks/communicator.h"

#include "app/command_line.h"
#include "app/commands.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/session.h"

namespace palpate::app {
namespace {

/// Reports an error on MPI rank 0 only, because all ranks that mpirun started find the same error.
void report_once(const std::string& error) {
  if (tasks::launch_of_environment().rank == 0) report_error(error);
}

/// Runs the command of a command line. @return the exit code
int run_command(int argc, char** argv, const AddCommands& add_commands) {
  CLI::App program{"Palpate lets a hand feel soft tissue through a force-feedback device, in real time."};
  program.name("palpate");
  program.set_version_flag("--version", std::string("palpate ") + kVersion);
  program.require_subcommand(1);
  int exit_code = kDone;
  add_commands(program, quoted_command_line("palpate", argc, argv), exit_code);
  if (argc == 1) {
    std::cerr << program.help();
    return kBadInput;
  }
  try {
    require_no_empty_word(argc, argv);
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
  // With SIGXFSZ ignored, write() returns an error for a file over the limit of `ulimit -f`, as for a full
  // disk.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGUSR1, SIG_IGN);  // a reset of faults has no effect before a run and after it
  const devices::SignalStack signal_stack;
  ResultStream results;
  const int exit_code = run_command(argc, argv, add_commands);
  const std::string failure = results.failure();
  if (failure.empty()) return exit_code;
  report_error("standard output: " + failure + (exit_code == kDone ? "; everything else is done" : ""));
  return exit_code == kDone ? kBadInput : exit_code;
}

}  // namespace palpate::app
