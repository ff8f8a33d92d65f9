// The program palpate-ros: the command `palpate ros`.
#include "app/program.h"
#include "ros/commands/ros.h"

int main(int argc, char** argv) {
  using namespace palpate::app;
  return run_program(argc, argv, [](CLI::App& program, const std::string& /*command_line*/, int& exit_code) {
    add_ros(program, exit_code);
  });
}
