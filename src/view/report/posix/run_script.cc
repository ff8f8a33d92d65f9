#include "view/report/run_script.h"

#include <cerrno>
#include <system_error>

#include <sys/wait.h>

#include "io/system/child_process.h"
#include "view/report/gnuplot.h"

namespace palpate::report {

int run_script(const std::filesystem::path& folder, const std::string& program) {
  std::error_code error;
  const int child = start_process(
      {.arguments = {program, "figure.gp"}, .folder = folder, .messages = folder / "errors.txt"}, error);
  if (error == std::errc::no_such_file_or_directory) {
    throw FigureError("gnuplot was not found: install the Debian package gnuplot-nox");
  }
  if (error) throw FigureError("gnuplot could not be started: " + error.message());
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace palpate::report
