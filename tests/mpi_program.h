#pragma once
// The program under mpirun.
#include <cstdlib>
#include <string>

#include <sys/wait.h>

#include "tests/program.h"

namespace palpate::tests {

/// Runs a shell command in the folder, with its output in the files out and err.
inline int shell(const Folder& folder, const std::string& command) {
  const std::string line = "cd '" + folder.path().string() + "' && " + command + " > out 2> err";
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline std::string by_mpi(int ranks, const std::string& words) {
  return "mpirun --allow-run-as-root --oversubscribe -n " + std::to_string(ranks) + " '" + PALPATE_PROGRAM +
         "' " + words;
}

}  // namespace palpate::tests
