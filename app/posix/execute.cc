#include "app/execute.h"

#include <cerrno>
#include <string>
#include <vector>

#include <unistd.h>

namespace palpate::app {

int execute(const std::filesystem::path& program, char** arguments) {
  std::string name = program.string();
  std::vector<char*> argv = {name.data()};
  while (*arguments != nullptr) argv.push_back(*arguments++);
  argv.push_back(nullptr);
  execv(name.c_str(), argv.data());
  return errno;
}

}  // namespace palpate::app
