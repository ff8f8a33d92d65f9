// `palpate bench`: replaces this process by the separate program palpate-bench (bench/main.cc).
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "app/commands.h"
#include "app/messages.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBenchProgram = "palpate-bench";

/// Replaces this process by `program`. Returns only when `program` cannot be executed.
void execute(std::string program, char** arguments) {
  std::vector<char*> words = {program.data()};
  while (*arguments != nullptr) words.push_back(*arguments++);
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
}

}  // namespace

void add_bench(CLI::App& program) {
  program.add_subcommand(
      "bench", "Measure the time of a tick, many hands and preparation, and compare with other libraries");
}

int execute_bench(char** arguments) {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (folder.is_absolute()) {  // empty on a system without /proc
    execute(folder / kBenchProgram, arguments);
    execute(folder.parent_path() / "bench" / kBenchProgram, arguments);
  }
  report_error(std::string(kBenchProgram) + " is not in " + folder.string() +
               ": build the target palpate_bench (cmake --build DIR --target palpate_bench), or install the "
               "package palpate");
  return kBadInput;
}

}  // namespace palpate::app
