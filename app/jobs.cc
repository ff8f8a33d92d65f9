#include "app/jobs.h"

#include <optional>
#include <string>

#include "core/base/parallel.h"
#include "palpate/error.h"

#include "app/numbers.h"

namespace palpate::app {

void add_jobs(CLI::App& command) {
  command.add_option_function<std::string>(
      "--jobs",
      [](const std::string& text) {
        static std::optional<ThreadLimit> limit;  // until the program ends
        const std::uint64_t most = parse_whole("--jobs", text);
        if (most < 1) throw InputError("--jobs " + text + ": must be at least 1");
        limit.emplace(most);
      },
      "threads; results are the same for any number (default: all processors)");
}

}  // namespace palpate::app
