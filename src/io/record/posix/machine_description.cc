#include <fstream>

#include <fmt/core.h>
#include <sys/utsname.h>

#include "io/record/machine.h"

namespace palpate::record {
namespace {

std::string processor_name() {
  std::ifstream facts("/proc/cpuinfo");
  for (std::string line; std::getline(facts, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

std::string machine_description() {
  std::string text = processor_name();
  utsname names{};
  if (uname(&names) == 0) {
    text += fmt::format(", {} {} {}", names.sysname, names.release, names.machine);
  }
  return text;
}

}  // namespace palpate::record
