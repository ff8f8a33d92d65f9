#pragma once
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace palpate {

/// A program to run in a child process.
struct ChildProcess {
  std::vector<std::string> arguments;  // the first is the program: a path, or a name that PATH finds
  std::filesystem::path folder{};      // where it runs; empty: where this process does
  std::filesystem::path messages{};    // file for its standard error; it then reads and prints nothing
  int input = -1;                      // file descriptor for its standard input; -1: this process's
  bool apart = false;  // it inherits no further file descriptor, and Ctrl-C in the terminal does not end it
};

/// [setup] Starts a child process. @param error why it does not start @return process id, for waitpid()
[[nodiscard]] int start_process(const ChildProcess& child, std::error_code& error);

}  // namespace palpate
