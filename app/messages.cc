#include "app/messages.h"

#include <memory>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace palpate::app {
namespace {

spdlog::logger& messages() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto made = spdlog::stderr_color_st("palpate");
    made->set_pattern("%n: %^%v%$");  // the colour is the level's, and only a terminal sees it
    return made;
  }();
  return *logger;
}

}  // namespace

void tell(std::string_view message) { messages().info("{}", message); }

void tell_error(std::string_view message) { messages().error("{}", message); }

}  // namespace palpate::app
