#include "app/messages.h"

#include <cstdlib>
#include <memory>
#include <string_view>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace palpate::app {
namespace {

spdlog::logger& messages() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto made = spdlog::stderr_color_mt("palpate");  // _mt: the progress thread logs, too
    made->set_pattern("%n: %^%v%$");                 // coloured by level, on a terminal only
    const char* level = std::getenv("PALPATE_LOG");  // NOLINT(concurrency-mt-unsafe): nothing writes it
    if (level != nullptr && std::string_view(level) == "debug") made->set_level(spdlog::level::debug);
    return made;
  }();
  return *logger;
}

}  // namespace

void report_message(std::string_view message) { messages().info("{}", message); }

void report_detail(std::string_view message) { messages().debug("{}", message); }

void report_error(std::string_view message) { messages().error("{}", message); }

}  // namespace palpate::app
