#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "run/devices/probe.h"

namespace palpate::devices {

/// Access to the machine. Tests replace / by a folder and the functions by their own.
struct Machine {
  std::filesystem::path root = "/";
  /// An environment variable; empty: not set.
  std::function<std::string(const char*)> variable = variable_of_process;
  /// Whether this user may read and write a file.
  std::function<bool(const std::filesystem::path&)> may_open = may_read_and_write;

  static std::string variable_of_process(const char* name);
  static bool may_read_and_write(const std::filesystem::path& file);
};

inline constexpr std::size_t kMaxReasons = 3;

/// [setup] Why a kind of device cannot be used on this machine, the most likely reason first, at most
/// kMaxReasons. Missing rights are a reason only for a device on USB, another program only if it has the
/// device open. Unreadable files neither add nor remove a reason.
/// @param library whether the system's loader finds the vendor's library
[[nodiscard]] std::vector<Reason> forcedimension_reasons(const Machine& machine, bool library);
[[nodiscard]] std::vector<Reason> touch_reasons(const Machine& machine, bool library);
[[nodiscard]] std::vector<Reason> haply_reasons(const Machine& machine);
[[nodiscard]] std::vector<Reason> mouse_reasons(const Machine& machine);
[[nodiscard]] std::vector<Reason> gamepad_reasons(const Machine& machine);

}  // namespace palpate::devices
