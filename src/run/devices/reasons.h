#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "run/devices/probe.h"

namespace palpate::devices {

/// How a machine is looked at. Tests give a folder that stands for / and answers of their own.
struct Machine {
  std::filesystem::path root = "/";
  /// An environment variable; empty: not set.
  std::function<std::string(const char*)> variable = variable_of_process;
  /// Whether this user may read and write a file.
  std::function<bool(const std::filesystem::path&)> may_open = may_read_and_write;

  static std::string variable_of_process(const char* name);
  static bool may_read_and_write(const std::filesystem::path& file);
};

inline constexpr std::size_t kMostReasons = 3;

/// [setup] What on this machine keeps a kind of device from being used, the likeliest first, at most
/// kMostReasons. A reason that the machine refutes is left out: rights only for a device that is on USB,
/// another program only where it has the device open. Files that cannot be read refute nothing and prove
/// nothing.
/// @param library whether the system's loader finds the maker's library
[[nodiscard]] std::vector<Reason> forcedimension_reasons(const Machine& machine, bool library);
[[nodiscard]] std::vector<Reason> touch_reasons(const Machine& machine, bool library);
[[nodiscard]] std::vector<Reason> haply_reasons(const Machine& machine);
[[nodiscard]] std::vector<Reason> mouse_reasons(const Machine& machine);
[[nodiscard]] std::vector<Reason> gamepad_reasons(const Machine& machine);

}  // namespace palpate::devices
