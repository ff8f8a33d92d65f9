// The program `palpate SUBCOMMAND`.
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/components.h"
#include "app/program.h"
#include "app/streams.h"

namespace {

void add_commands(CLI::App& program, const std::string& command_line, int& exit_code) {
  using namespace palpate::app;
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
  add_component(program, "ros");
  add_devices(program, exit_code);
  add_component(program, "fit");
  add_score(program, command_line, exit_code);
  for (const char* command : {"study", "sweep", "generate", "validate", "bench"}) {
    add_component(program, command);
  }
  add_list(program, exit_code);
  add_doctor(program, exit_code);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate::app;
  prepare_streams();
  std::vector<std::string> arguments = utf8_arguments(argc, argv);
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  std::string help = "--help";
  if (argc > 1 && arguments[1] == "help") {  // help run: run --help
    words.erase(words.begin() + 1);
    words.push_back(help.data());
  }
  words.push_back(nullptr);
  if (argc > 1 && is_of_component(words[1])) return execute_component(words.data() + 1);
  return run_program(argc, words.data(), add_commands);
}
