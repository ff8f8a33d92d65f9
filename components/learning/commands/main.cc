// The program palpate-learning: the command `palpate generate`.
#include "app/program.h"
#include "learning/commands/generate.h"

int main(int argc, char** argv) {
  using namespace palpate::app;
  return run_program(argc, argv, [](CLI::App& program, const std::string& /*command_line*/, int& exit_code) {
    add_generate(program, exit_code);
  });
}
