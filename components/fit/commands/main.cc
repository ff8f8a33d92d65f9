// The program palpate-fit: the commands `palpate fit`, `palpate sweep` and `palpate validate`.
#include "app/program.h"
#include "fit/commands/commands.h"

int main(int argc, char** argv) {
  using namespace palpate::app;
  return run_component_program(argc, argv,
                               [](CLI::App& program, const std::string& command_line, int& exit_code) {
                                 add_fit(program, command_line, exit_code);
                                 add_sweep(program, exit_code);
                                 add_validate(program, command_line, exit_code);
                               });
}
