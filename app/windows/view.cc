// `palpate view`, in a program without a window and pictures.
#include <string>

#include "palpate/error.h"

#include "app/commands.h"

namespace palpate::app {

void add_view(CLI::App& program, int& /*exit_code*/) {
  CLI::App* command = program.add_subcommand("view", "Show a recording (not in palpate for Windows)");
  command->allow_extras();
  command->callback([] {
    throw InputError(
        "view: palpate for Windows has no window and draws no pictures; palpate replay, export and score "
        "read the recording here, and palpate view shows it on Linux");
  });
}

}  // namespace palpate::app
