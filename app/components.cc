// Commands of components: programs beside palpate, which replace it (`palpate fit` executes palpate-fit).
// This table is all that the product knows of them.
#include "app/components.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "io/system/files.h"
#include "io/system/path_text.h"
#include "io/system/plugin.h"
#include "palpate/error.h"
#include "run/tasks/communicator.h"

#include "app/commands.h"
#include "app/execute.h"
#include "app/messages.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct ComponentCommand {
  std::string_view name;
  const char* program;
  const char* target;   // of the build
  const char* package;  // of Debian
  const char* description;
};

constexpr std::array kCommands{
    ComponentCommand{"ros", "palpate-ros", "palpate-ros", "palpate-ros",
                     "Run one interaction and publish it as ROS 2 topics"},
    ComponentCommand{"fit", "palpate-fit", "palpate-fit", "palpate-fit",
                     "Identify tissue parameters, with confidence intervals, from force-displacement curves"},
    ComponentCommand{"study", "palpate-study", "palpate-study", "palpate-study",
                     "Plan, run and analyse an experiment: does the touch noise help people?"},
    ComponentCommand{"sweep", "palpate-fit", "palpate-fit", "palpate-fit",
                     "Run a scene over a grid of parameter values, and write a table of results"},
    ComponentCommand{"generate", "palpate-learning", "palpate-learning", "palpate-learning",
                     "Write episodes for learning: observations, actions and rewards of a policy"},
    ComponentCommand{"validate", "palpate-fit", "palpate-fit", "palpate-fit",
                     "Compare the forces and the deformation of a tissue with measurements"},
    ComponentCommand{
        "bench", "palpate-bench", "palpate_bench", "palpate",
        "Measure the time of a tick, many hands and preparation, and compare with other libraries"},
};

const ComponentCommand* find(std::string_view name) noexcept {
  const auto* found = std::find_if(kCommands.begin(), kCommands.end(),
                                   [&](const ComponentCommand& command) { return command.name == name; });
  return found == kCommands.end() ? nullptr : found;
}

}  // namespace

void add_component(CLI::App& program, std::string_view name) {
  add_component_command(program, name)->callback([name] {
    throw InputError(std::string(name) + ": must be the first word after palpate");
  });
}

CLI::App* add_component_command(CLI::App& program, std::string_view name) {
  const ComponentCommand* command = find(name);
  return program.add_subcommand(std::string(name), command != nullptr ? command->description : "");
}

bool is_of_component(std::string_view name) noexcept { return find(name) != nullptr; }

int execute_component(char** arguments) {
  const ComponentCommand& command = *find(arguments[0]);
  const fs::path folder = folder_of_program();
  int reason = ENOENT;
  if (!folder.empty()) {
    for (const fs::path& place : {folder, folder.parent_path() / "libexec" / "palpate"}) {
      const int why = execute(place / command.program, arguments);
      if (reason == ENOENT) reason = why;
    }
  }
  // mpirun started several processes, which all fail alike.
  if (tasks::launch_of_environment().rank != 0) return kBadInput;
  if (reason != ENOENT) {
    report_error(fmt::format("{}: {} cannot be executed: {}", command.name, command.program,
                             std::generic_category().message(reason)));
    return kBadInput;
  }
  if (kIsWindows) {
    report_error(fmt::format(
        "{}: needs the program {}.exe beside this one, and it is not there; palpate on Linux has it",
        command.name, command.program));
    return kBadInput;
  }
  report_error(
      fmt::format("{}: needs the program {}, which is not in {}: install the package {}, or build it "
                  "(cmake --build DIR --target {})",
                  command.name, command.program, to_text(folder), command.package, command.target));
  return kBadInput;
}

}  // namespace palpate::app
