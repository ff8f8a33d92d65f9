// The program palpate-study: the command `palpate study`.
#include "app/program.h"
#include "study/commands/study_commands.h"

int main(int argc, char** argv) {
  return palpate::app::run_component_program(argc, argv, palpate::app::add_study);
}
