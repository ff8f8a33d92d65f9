// The one program: `palpate SUBCOMMAND`. Bad usage and bad input end with exit code 2 and one line in words.
#include <exception>
#include <iostream>

#include "palpate/base/error.h"

#include "app/commands.h"

int main(int argc, char** argv) {
  using namespace palpate::app;
  CLI::App program{"Palpate lets a hand feel soft tissue through a force-feedback device, in real time."};
  program.name("palpate");
  program.require_subcommand(1);
  int exit_code = kDone;
  add_run(program, exit_code);
  add_demo(program, exit_code);
  add_model(program, exit_code);
  add_noise(program, exit_code);
  add_inspect(program, exit_code);
  add_replay(program, exit_code);
  add_export(program, exit_code);
  add_repair(program, exit_code);
  add_bench(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kBadInput;
  } catch (const palpate::InputError& error) {
    std::cerr << "palpate: " << error.what() << '\n';
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "palpate: " << error.what() << '\n';
    return kBadInput;
  }
  return exit_code;
}
